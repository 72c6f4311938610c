#pragma once

namespace sightline {

/// Without HOME, PoCL would keep compiled kernels in /tmp, where others may write: sends it to the cache
/// folder of the user's entry in the password file, or tells it to keep nothing. Sets the environment: before
/// the first thread and the first OpenCL call.
void keepPoclCacheInUsersFolder();

}  // namespace sightline
