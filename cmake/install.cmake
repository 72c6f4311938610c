# The library as other projects get it, installed or by add_subdirectory: two archives of the rooms' objects,
#   sightline::pvs        reads and writes .pvs files, says what is seen from where; zstd, xxhash and fmt
#   sightline::sightline  loads scenes and bakes, too
# with the headers below, which are all that is promised to stay.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(pvs_headers base/error.h base/named_triangles.h shared/language.h shared/types.h cell/view_cell.h cell/cell_problem.h cell/cell_contains.h
    pvs/method.h pvs/order.h pvs/bake_params.h pvs/cell_stats.h pvs/cell_pvs.h pvs/pvs_file.h pvs/missing_bound.h pvs/cell_summary.h
    pvs/visible_from.h)
set(sightline_headers base/extents.h scene/find_objects.h shared/placement.h shared/box.h scene/scene.h scene/surfaces.h shared/surface.h shared/triangle.h
    shared/two_float.h formats/load_scene.h formats/cells_file.h trace/device_info.h
    device/device_options.h device/registry/device_names.h gvs/bake_progress.h gvs/bake_trace.h gvs/leaks.h bake/bake_events.h
    bake/require_scene.h api/session.h api/bake.h)
set(all_headers ${pvs_headers} ${sightline_headers})
list(TRANSFORM all_headers PREPEND ${PROJECT_SOURCE_DIR}/core/ OUTPUT_VARIABLE header_inputs)
list(TRANSFORM all_headers PREPEND ${PROJECT_BINARY_DIR}/include/sightline/ OUTPUT_VARIABLE header_files)
list(JOIN all_headers "|" header_list)
add_custom_command(
  OUTPUT ${header_files}
  COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR} -DTO=${PROJECT_BINARY_DIR}/include "-DHEADERS=${header_list}"
          -P ${CMAKE_CURRENT_LIST_DIR}/public_headers.cmake
  DEPENDS ${header_inputs} ${CMAKE_CURRENT_LIST_DIR}/public_headers.cmake
  VERBATIM)
add_custom_target(sightline_headers ALL DEPENDS ${header_files})

# sightline::NAME, an archive of the objects of TARGETS. PUBLIC: libraries that its HEADERS need, PRIVATE: others.
function(sl_library name)
  cmake_parse_arguments(PARSE_ARGV 1 library "" "" "HEADERS;TARGETS;PUBLIC;PRIVATE")
  set(target sightline_library_${name})
  list(TRANSFORM library_TARGETS REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>" OUTPUT_VARIABLE objects)
  list(TRANSFORM library_HEADERS PREPEND ${PROJECT_BINARY_DIR}/include/sightline/)
  add_library(${target} STATIC ${objects})
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_BINARY_DIR}/include FILES ${library_HEADERS})
  add_dependencies(${target} sightline_headers)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PUBLIC glm::glm ${library_PUBLIC} PRIVATE ${library_PRIVATE})
  string(REPLACE sightline_sightline sightline output sightline_${name})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} OUTPUT_NAME ${output} LINKER_LANGUAGE CXX
                        ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
  add_library(sightline::${name} ALIAS ${target})
  install(TARGETS ${target} EXPORT ${name}_targets ARCHIVE FILE_SET HEADERS)
  install(EXPORT ${name}_targets NAMESPACE sightline:: FILE ${name}_targets.cmake
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sightline)
endfunction()

sl_library(pvs HEADERS ${pvs_headers} TARGETS sightline_base sightline_io sightline_cell sightline_pvs
           PRIVATE fmt::fmt PkgConfig::xxhash PkgConfig::zstd)

set(objects sightline_bvh sightline_scene sightline_path sightline_formats sightline_sampling sightline_trace sightline_device
    sightline_device_gpu sightline_device_cpu sightline_device_naive sightline_device_embree sightline_device_registry sightline_page
    report_page_parts sightline_gvs sightline_bake sightline_api)
set(packages fmt::fmt PkgConfig::draco PkgConfig::xxhash TBB::tbb PkgConfig::webp PNG::PNG Threads::Threads
    meshoptimizer::meshoptimizer ${CMAKE_DL_LIBS})
if(SL_WITH_OPENCL)
  list(APPEND objects cl_kernel_sources sightline_opencl sightline_device_opencl)
  list(APPEND packages OpenCL::OpenCL)
endif()
if(SL_WITH_VULKAN)
  list(APPEND objects vk_shader_code sightline_vulkan sightline_device_vulkan)
endif()
if(embree_FOUND)
  list(APPEND packages embree)
endif()
sl_library(sightline HEADERS ${sightline_headers} TARGETS ${objects} PUBLIC sightline_library_pvs PRIVATE ${packages})

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/sightlineConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/sightlineConfig.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sightline)
# Until 1.0 any minor version may change what the headers promise.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/sightlineConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/sightlineConfig.cmake ${PROJECT_BINARY_DIR}/sightlineConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sightline)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/sightline)
if(SL_WITH_CLI)
  install(TARGETS sightline RUNTIME)
endif()
