// SPDX-License-Identifier: Apache-2.0
#include "regression/host/plugin_host.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>

namespace tauext::gate {

Plugin::Plugin(const std::string& file_path, const std::string& shown) {
  const std::string path = shown.empty() ? file_path : shown;
  // with a slash dlopen looks at this file and nowhere else
  const std::string file = std::filesystem::absolute(file_path).string();
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

std::vector<double> example(const Plugin& plugin, int kernel) {
  const tauext_plugin& api = plugin.api();
  std::vector<double> samples(static_cast<std::size_t>(api.sample_size(kernel)) * kExampleSamples);
  api.example(kernel, kExampleSamples, samples.data());
  return samples;
}

Work::Work(const Plugin& plugin, int kernel, const std::vector<double>& samples)
    : api_(&plugin.api()), instance_(nullptr, api_->destroy) {
  const auto size = static_cast<std::size_t>(api_->sample_size(kernel));
  if (samples.size() != size * kExampleSamples) {
    throw std::runtime_error(plugin.name(kernel) +
                             ": the two builds differ in the number of joints");
  }
  instance_.reset(api_->create(kernel, static_cast<int>(samples.size() / size), samples.data()));
  if (!instance_) throw std::runtime_error(plugin.name(kernel) + ": out of memory");
}

}  // namespace tauext::gate
