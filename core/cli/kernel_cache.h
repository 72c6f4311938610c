#pragma once

namespace sightline {

/// Without HOME, PoCL would keep compiled kernels in /tmp, where others may write: sends it to the cache
/// folder of the user's entry in the password file, or tells it to keep nothing. By the environment, which is
/// the program's to set and not the library's: before the first OpenCL call, while there is one thread.
void keepKernelsInUsersFolder();

}  // namespace sightline
