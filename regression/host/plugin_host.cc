// SPDX-License-Identifier: Apache-2.0
#include "regression/host/plugin_host.h"

#include <dlfcn.h>
#include <elf.h>
#include <fmt/format.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <stdexcept>
#include <utility>

namespace tauext::gate {
namespace {

// dlopen dies of a library that is cut off; the section headers are its end
bool cut_off(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  Elf64_Ehdr head{};
  if (!in.read(reinterpret_cast<char*>(&head), sizeof head)) return false;  // dlopen says why
  if (std::memcmp(head.e_ident, ELFMAG, SELFMAG) != 0) return false;
  const std::uint64_t size = std::filesystem::file_size(file);
  return head.e_shoff > size ||
         std::uint64_t{head.e_shnum} * head.e_shentsize > size - head.e_shoff;
}

}  // namespace

Plugin::Plugin(const std::string& file_path, const std::string& shown) {
  const std::string path = shown.empty() ? file_path : shown;
  // with a slash dlopen looks at this file and nowhere else
  const std::string file = std::filesystem::absolute(file_path).string();
  if (cut_off(file)) throw std::runtime_error(path + ": cut off; build the plug-in anew");
  library_ = std::shared_ptr<void>(::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL), [](void* l) {
    if (l) ::dlclose(l);
  });
  if (!library_)
    throw std::runtime_error(
        fmt::format("{}: no plug-in; tauext_add_plugin makes one ({})", path, ::dlerror()));
  using Get = const tauext_plugin* (*)();
  const auto get = reinterpret_cast<Get>(::dlsym(library_.get(), TAUEXT_PLUGIN_SYMBOL));
  if (!get) {
    throw std::runtime_error(fmt::format("{}: no plug-in: it has no {} (see bench/kit/kernels.h)",
                                         path, TAUEXT_PLUGIN_SYMBOL));
  }
  api_ = get();
  if (!api_) throw std::runtime_error(path + ": no plug-in: it gives nothing");
  if (api_->abi != TAUEXT_PLUGIN_ABI) {
    throw OtherAbi(fmt::format("{}: a plug-in of ABI {}, this program speaks {}", path, api_->abi,
                               TAUEXT_PLUGIN_ABI));
  }
  require_different_names(path);
}

void Plugin::require_different_names(const std::string& path) const {
  for (int i = 0; i < count(); ++i) {
    if (find(name(i)) != i) {
      throw std::runtime_error(fmt::format("{}: two kernels are called {}", path, name(i)));
    }
  }
}

int Plugin::find(const std::string& wanted) const {
  for (int i = 0; i < count(); ++i) {
    if (name(i) == wanted) return i;
  }
  return -1;
}

std::uint64_t Plugin::address(int kernel) const {
  const auto* code = reinterpret_cast<const char*>(api_->runner(kernel));
  Dl_info info;
  if (::dladdr(code, &info) == 0) throw std::runtime_error(name(kernel) + ": in no library");
  return static_cast<std::uint64_t>(code - static_cast<const char*>(info.dli_fbase));
}

Samples::Samples(const Plugin& plugin, int kernel, unsigned seed, int n) : count_(n) {
  const auto size = static_cast<std::size_t>(plugin.api().sample_size(kernel));
  auto plain = std::make_shared<std::vector<double>>(size * static_cast<std::size_t>(n));
  plugin.api().life(kernel, seed, n, plain->data());
  plain_ = std::move(plain);
  unpack(plugin, kernel);
}

Samples::Samples(const Plugin& plugin, int kernel, const Samples& same)
    : count_(same.count_), plain_(same.plain_) {
  const auto size = static_cast<std::size_t>(plugin.api().sample_size(kernel));
  if (plain_->size() != size * static_cast<std::size_t>(count_)) {
    throw std::runtime_error(plugin.name(kernel) +
                             ": the two builds differ in the number of joints");
  }
  unpack(plugin, kernel);
  // one memory for both, where both read the same
  if (bytes_ == same.bytes_ && std::memcmp(unpacked_.get(), same.unpacked_.get(), bytes_) == 0) {
    unpacked_ = same.unpacked_;
  }
}

void Samples::unpack(const Plugin& plugin, int kernel) {
  constexpr std::size_t kLine = 64;
  bytes_ = static_cast<std::size_t>(plugin.api().sample_bytes(kernel)) *
           static_cast<std::size_t>(count_);
  const std::shared_ptr<void> memory(
      std::aligned_alloc(kLine, (bytes_ + kLine - 1) / kLine * kLine), std::free);
  if (!memory) throw std::bad_alloc();
  std::memset(memory.get(), 0, bytes_);
  plugin.api().unpack(kernel, count_, plain_->data(), memory.get());
  unpacked_ = memory;
}

const Samples& Lives::of(const Plugin& plugin, int kernel) {
  const std::string name = plugin.name(kernel);
  const Robot robot{name.substr(0, name.find('/')), plugin.api().sample_size(kernel)};
  const auto read = read_.find({&plugin.api(), robot});
  if (read != read_.end()) return read->second;
  auto first = first_.find(robot);
  if (first == first_.end()) {
    first = first_.emplace(robot, Samples(plugin, kernel, seed_, n_)).first;
  }
  return read_.emplace(std::pair(&plugin.api(), robot), Samples(plugin, kernel, first->second))
      .first->second;
}

Work::Work(const Plugin& plugin, int kernel, Samples samples)
    : api_(&plugin.api()),
      samples_(std::move(samples)),
      run_(api_->runner(kernel)),
      instance_(api_->create(kernel, samples_.count(), samples_.unpacked()), api_->destroy) {
  if (!instance_) throw std::runtime_error(plugin.name(kernel) + ": out of memory");
}

std::string Work::state() const {
  std::string bytes(static_cast<std::size_t>(api_->state(instance_.get(), 0, nullptr)), '\0');
  api_->state(instance_.get(), static_cast<int>(bytes.size()), bytes.data());
  return bytes;
}

}  // namespace tauext::gate
