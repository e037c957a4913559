// SPDX-License-Identifier: Apache-2.0
#include "regression/code/plugin_code.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "mjcf/trace/digest.h"
#include "mjcf/trace/input_file.h"
#include "regression/host/child.h"
#include "regression/host/files.h"

namespace tauext::gate {
namespace {

// what a name is: a label, nullptr and "" if it is none, of a unit, and so far behind it
struct Place {
  std::pair<const Assembly*, std::string_view> label = {};
  std::string offset = {};
};

Place place_in(const Assembly& unit, std::string_view name) {
  auto [label, offset] = unit.meant(name);
  return label.empty() ? Place() : Place{{&unit, label}, std::move(offset)};
}

// Text of blocks with every label by its number, in the order of their first mention; the places of
// labels that nothing mentions are not said, since they are the debugger's and the unwinder's.
class Namer {
 public:
  // resolve(name) says which place a name is, and is called for each mention
  template <class Resolve>
  void mention(const Block& block, Resolve&& resolve) {
    for (const std::string_view line : block.lines) {
      if (!label_of(line).empty()) continue;
      const auto mention = [&](std::string_view name) {
        if (const Place place = resolve(name); place.label.first) {
          numbers_.try_emplace(place.label, numbers_.size());
        }
      };
      for_each_name(line, mention, [](std::string_view) {});
    }
  }

  template <class Resolve>
  void write(const Block& block, std::string& to, Resolve&& resolve) const {
    for (const std::string_view line : block.lines) {
      const std::string_view label = label_of(line);
      if (!label.empty() && !numbers_.contains(resolve(label).label)) continue;
      const auto say = [&](std::string_view name) {
        const Place place = resolve(name);
        const auto it = numbers_.find(place.label);
        if (it == numbers_.end()) return void(to.append(name));
        to += fmt::format("<{}{}>", it->second, place.offset);
      };
      for_each_name(line, say, [&](std::string_view text) { to.append(text); });
      to += '\n';
    }
    to += '\n';
  }

 private:
  std::map<std::pair<const Assembly*, std::string_view>, std::size_t> numbers_;
};

constexpr int kPeriod = 512;  // [bytes] what lies there runs alike, as far as anybody has seen
constexpr int kStep = 16;     // [bytes]

// Steele, Lea and Flood 2014, splitmix64
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

bool never_passed(std::string_view word) {
  constexpr std::string_view kWords[] = {"jmp", "ret", "b", "br"};  // of x86 and of aarch64
  return std::find(std::begin(kWords), std::end(kWords), word) != std::end(kWords);
}

// as lay_out() says
std::string laid_out(const std::string& assembly, std::uint64_t seed, const LayoutNames& names) {
  // aarch64's instructions are whole words, and its assembler wants to know
  const bool words = assembly.find("\t.arch armv8") != std::string::npos;
  std::set<std::string_view> functions;
  std::uint64_t of_function = 0, place = 0;
  std::string out;
  out.reserve(assembly.size() * 5 / 4);
  const auto skip = [&](std::uint64_t bytes) {
    if (bytes > 0) out += fmt::format("\t.skip {}\n", bytes);
  };
  for (const std::string_view line : lines_of(assembly)) {
    const std::string_view word = first_word(line), label = label_of(line);
    if (const std::string_view function = function_of(line); !function.empty()) {
      functions.insert(function);
    }
    if (functions.contains(label)) {
      const auto it = names.find(label);
      of_function = mixed(fnv1a(it == names.end() ? label : it->second) + mixed(seed));
      place = 0;
      out += fmt::format("\t.balign {}\n", kPeriod);
      skip(kStep * (of_function % (kPeriod / kStep)));
    }
    out.append(line).push_back('\n');
    if (never_passed(word)) {
      const std::uint64_t random = mixed(of_function + ++place);
      const std::uint64_t bytes = 1 + (random >> 8) % 63;
      if (random % 2 == 0) skip(words ? (bytes + 3) / 4 * 4 : bytes);
    }
  }
  return out;
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
  if (link_.size() < 4) throw std::runtime_error(folder + "/link: cut off; build the plug-in anew");
  // what is judged by its assembly must be made of it
  const std::string hash = run_child({"sha256sum", plugin});
  if (hash.find(link_.front()) == std::string::npos) {
    throw std::runtime_error(folder +
                             ": is of another build than the plug-in beside it; copy both");
  }
  folder_ = link_[1];
  link_.erase(link_.begin(), link_.begin() + 2);
  for (const std::string& argument : link_) {
    if (argument != fmt::format("@{}", units_.size())) continue;
    const std::string path = fmt::format("{}/{}.s", folder, units_.size());
    units_.emplace_back(read_whole(path), path);
  }
  if (units_.empty()) throw std::runtime_error(folder + "/link: names no assembly");
}

std::string PluginCode::reached(const std::string& function) const {
  const auto find = [&](const Assembly& from, std::string_view name) {
    Place place = place_in(from, name);
    if (name.starts_with(".L")) return place;
    for (std::size_t i = 0; i < units_.size() && !place.label.first; ++i) {
      place = place_in(units_[i], name);
    }
    return place;
  };
  if (!find(units_.front(), function).label.first) {
    throw std::runtime_error(fmt::format("{}: {} is not in its assembly", path_, function));
  }
  Namer namer;
  std::set<const Block*> seen;
  std::vector<std::pair<const Assembly*, const Block*>> places;  // and in whose words they are
  bool all_known = true;
  const auto reach = [&](const Assembly& from, std::string_view name) {
    const Place place = find(from, name);
    const auto [unit, label] = place.label;
    const Block* const block = unit ? unit->find(label) : nullptr;
    if (block && seen.insert(block).second) places.emplace_back(unit, block);
    all_known &= block ? !block->writable : !name.starts_with(".L");
    return place;
  };
  reach(units_.front(), function);
  for (std::size_t i = 0; i < places.size() && all_known; ++i) {
    const auto [unit, block] = places[i];
    namer.mention(*block, [&, unit = unit](std::string_view name) { return reach(*unit, name); });
  }
  if (!all_known) return "";
  std::string out;
  for (const auto& [unit, block] : places) {
    namer.write(*block, out, [&, unit = unit](std::string_view name) { return find(*unit, name); });
  }
  return out;
}

std::map<std::string, std::string> PluginCode::shapes() const {
  std::map<std::string, std::string> shapes;
  for (const Assembly& unit : units_) {
    const auto find = [&](std::string_view name) { return place_in(unit, name); };
    for (const Block& block : unit.blocks()) {
      if (!block.function) continue;
      Namer namer;
      namer.mention(block, find);
      namer.write(block, shapes[std::string(block.name)], find);
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
    try {
      run_child(argv);
    } catch (const std::runtime_error&) {  // it has said why
      throw std::runtime_error(fmt::format(
          "{}.code/: {} cannot assemble and link it in {}, as its link says; build it here anew",
          path_, link_.front(), folder_));
    }
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
