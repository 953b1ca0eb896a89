#include <dlfcn.h>
#include <link.h>

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <new>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/core/process_mutex.hpp"
#include "stats/openturns/openturns.hpp"

namespace mottle::stats {

namespace {

namespace fs = std::filesystem;

/// Folders in which the system looks for the libraries of a program or library. `dlopen` by name alone would do the
/// same, but sanitizers call it in the program's place, and then it does not know the program's run path.
std::vector<fs::path> library_folders(link_map* object) {
  Dl_serinfo size = {};
  if (::dlinfo(object, RTLD_DI_SERINFOSIZE, &size) != 0) return {};
  std::vector<std::max_align_t> buffer(size.dls_size / sizeof(std::max_align_t) + 1);
  auto* const list = new (buffer.data()) Dl_serinfo(size);
  if (::dlinfo(object, RTLD_DI_SERINFO, list) != 0) return {};
  std::vector<fs::path> folders;
  const Dl_serpath* path = list->dls_serpath;
  for (unsigned int i = 0; i < list->dls_cnt; ++i, ++path) {
    if (*path->dls_name == '/') folders.emplace_back(path->dls_name);  // never what lies where one happens to be
  }
  return folders;
}

/// Folders that may hold the module, in order.
std::vector<fs::path> module_folders() {
  std::vector<fs::path> folders;
  if (const char* wish = std::getenv("MOTTLE_MODULES"); wish != nullptr && *wish != '\0') folders.emplace_back(wish);
  Dl_info object = {};
  void* map = nullptr;
  if (::dladdr1(reinterpret_cast<const void*>(&openturns), &object, &map, RTLD_DL_LINKMAP) == 0) return folders;
  // A program's own name is what it was called by, which need not be a path.
  auto* const link = static_cast<link_map*>(map);
  std::error_code ignored;
  const fs::path file = *link->l_name == '\0' ? fs::read_symlink("/proc/self/exe", ignored) : fs::path(link->l_name);
  folders.push_back(file.parent_path());
  for (fs::path& folder : library_folders(link)) folders.push_back(std::move(folder));
  return folders;
}

const OpenTurns& load_module() {
  const fs::path file = find_openturns_module(module_folders());
  void* const module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) {
    throw SystemFailure(fmt::format("the module for OpenTURNS cannot be loaded: {}", ::dlerror()));
  }
  const auto* const version = static_cast<const int*>(::dlsym(module, "mottle_openturns_version"));
  auto* const give = reinterpret_cast<GiveOpenTurns*>(::dlsym(module, "mottle_openturns"));
  if (version == nullptr || *version != k_openturns_version || give == nullptr) {
    throw SystemFailure(
        fmt::format("{}: belongs to another version of Mottle; install both from one build", file.string()));
  }
  return *give();
}

}  // namespace

fs::path find_openturns_module(const std::vector<fs::path>& folders) {
  constexpr const char* k_name = "mottle_openturns.so";
  for (const fs::path& folder : folders) {
    std::error_code ignored;
    if (fs::exists(folder / k_name, ignored)) return folder / k_name;
  }
  throw SystemFailure(
      fmt::format("Sobol designs and the surrogates kriging and chaos need the module for OpenTURNS, {}, which is not "
                  "installed; install the package mottle, or name the module's folder in the environment, as in "
                  "MOTTLE_MODULES=/opt/mottle/lib/mottle",
                  k_name));
}

const OpenTurns& openturns() {
  const NoFork no_fork;
  static const OpenTurns& object = load_module();
  return object;
}

}  // namespace mottle::stats
