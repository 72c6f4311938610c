// What the shaders of stages get by push constants (scalar layout).
#ifndef SL_VULKAN_PUSH_H
#define SL_VULKAN_PUSH_H
#include "core/shared/language.h"
SL_NAMESPACE_BEGIN

/// One dispatch of a launch: it runs the work items first_item .. item_end - 1.
SL_STRUCT(VulkanPush) {
  uint64 launch;  ///< address of what the shader knows to read
  uint first_item;
  uint item_end;
};

SL_NAMESPACE_END
#endif
