// SPDX-License-Identifier: Apache-2.0
#include "regression/code/plugin_code.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>

#include "mjcf/trace/input_file.h"
#include "regression/host/child.h"
#include "regression/host/files.h"

namespace tauext::gate {
namespace {

// a line of a block with every label by its number, in the order of their first mention
class Namer {
 public:
  template <class Known>
  void write(std::string_view line, std::string& to, Known&& known) {
    for_each_name(
        line,
        [&](std::string_view name) {
          if (!known(name)) return void(to.append(name));
          to += fmt::format("<{}>", numbers_.try_emplace(name, numbers_.size()).first->second);
        },
        [&](std::string_view text) { to.append(text); });
    to += '\n';
  }

 private:
  std::map<std::string_view, std::size_t> numbers_;
};

// labels that nothing but a debugger or an unwinder asks for
bool of_no_use(std::string_view label) {
  return label.starts_with(".LF") || label.starts_with(".LEH") || label.starts_with(".LV") ||
         label.starts_with(".LB") || label.starts_with(".LHOT") || label.starts_with(".LCOLD") ||
         label.starts_with(".LLSDA") || label.starts_with(".Ltmp");
}

}  // namespace

PluginCode::PluginCode(const std::string& plugin) : path_(plugin) {
  const std::string folder = plugin + ".code";
  if (!std::filesystem::exists(folder + "/link")) {
    throw std::runtime_error(folder +
                             "/link: No such file or directory; tauext_add_plugin writes it");
  }
  const std::string link = read_whole(folder + "/link");
  for (const std::string_view line : lines_of(link)) link_.emplace_back(line);
  if (link_.size() < 3) throw std::runtime_error(folder + "/link: cut off");
  folder_ = link_.front();
  link_.erase(link_.begin());
  for (const std::string& argument : link_) {
    if (argument != fmt::format("@{}", units_.size())) continue;
    const std::string path = fmt::format("{}/{}.s", folder, units_.size());
    units_.emplace_back(read_whole(path), path);
  }
  if (units_.empty()) throw std::runtime_error(folder + "/link: names no assembly");
}

std::string PluginCode::reached(const std::string& function) const {
  using Place = std::pair<const Assembly*, const Block*>;
  const auto find = [&](const Assembly& from, std::string_view name) -> Place {
    if (const Block* own = from.find(name)) return {&from, own};
    if (name.starts_with(".L")) return {};
    for (const Assembly& unit : units_) {
      if (const Block* other = unit.find(name)) return {&unit, other};
    }
    return {};
  };
  std::deque<Place> to_do = {find(units_.front(), function)};
  if (!to_do.front().second) {
    throw std::runtime_error(fmt::format("{}: {} is not in its assembly", path_, function));
  }
  std::set<const Block*> seen = {to_do.front().second};
  std::map<const Assembly*, Namer> namers;
  std::string out;
  for (; !to_do.empty(); to_do.pop_front()) {
    const auto [unit, block] = to_do.front();
    if (block->writable) return "";
    for (const std::string_view line : block->lines) {
      if (of_no_use(label_of(line))) continue;
      namers[unit].write(line, out, [&, unit = unit](std::string_view name) {
        const Place place = find(*unit, name);
        if (place.second && seen.insert(place.second).second) to_do.push_back(place);
        return place.second != nullptr;
      });
    }
    out += '\n';
  }
  return out;
}

std::map<std::string, std::string> PluginCode::shapes() const {
  std::map<std::string, std::string> shapes;
  for (const Assembly& unit : units_) {
    for (const Block& block : unit.blocks()) {
      if (!block.function) continue;
      Namer namer;
      std::string& shape = shapes[std::string(block.name)];
      for (const std::string_view line : block.lines) {
        if (of_no_use(label_of(line))) continue;
        namer.write(line, shape, [&](std::string_view name) { return unit.find(name) != nullptr; });
      }
    }
  }
  return shapes;
}

LayoutNames paired_names(const PluginCode& base, const PluginCode& head) {
  const std::map<std::string, std::string> before = base.shapes(), after = head.shapes();
  const auto left_over = [](const auto& of, const auto& beside) {
    std::map<std::string, std::vector<std::string>> by_shape;
    for (const auto& [name, shape] : of) {
      if (!beside.contains(name)) by_shape[shape].push_back(name);
    }
    return by_shape;
  };
  const auto gone = left_over(before, after);
  LayoutNames names;
  for (const auto& [shape, here] : left_over(after, before)) {
    const auto it = gone.find(shape);
    if (it == gone.end()) continue;
    // several of one shape: in the order of their names
    for (std::size_t i = 0; i < std::min(here.size(), it->second.size()); ++i) {
      names[here[i]] = it->second[i];
    }
  }
  return names;
}

void PluginCode::lay_out(std::uint64_t seed, const LayoutNames& names,
                         const std::string& out) const {
  const TemporaryFolder work;
  const auto run = [&](std::vector<std::string> argv) {
    argv.insert(argv.begin(), {"env", "--chdir=" + folder_});
    run_child(argv);
  };
  std::vector<std::string> link = link_;
  for (std::size_t i = 0; i < units_.size(); ++i) {
    const std::string source = fmt::format("{}/{}.s", work.path(), i), object = source + ".o";
    std::ofstream file(source, std::ios::binary);
    file << laid_out(units_[i].text(), seed, names);
    if (!file.flush()) throw std::runtime_error(source + ": cannot be written");
    run({link_.front(), "-c", source, "-o", object});
    std::replace(link.begin(), link.end(), fmt::format("@{}", i), object);
  }
  std::replace(link.begin(), link.end(), std::string("@out"), out);
  run(link);
}

}  // namespace tauext::gate
