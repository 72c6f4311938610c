#include "core/cli/pocl_cache.h"

#include <pwd.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace sightline {

void keepPoclCacheInUsersFolder() {
  if (std::getenv("POCL_CACHE_DIR") || std::getenv("XDG_CACHE_HOME") || std::getenv("HOME")) return;
  const passwd* user = getpwuid(getuid());
  if (user && user->pw_dir && user->pw_dir[0] == '/') {
    setenv("POCL_CACHE_DIR", (std::string(user->pw_dir) + "/.cache/pocl").c_str(), 0);
  } else {
    setenv("POCL_KERNEL_CACHE", "0", 0);
  }
}

}  // namespace sightline
