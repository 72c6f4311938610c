# Writes the headers of the installed library: core/pvs/pvs_file.h as sightline/pvs/pvs_file.h, so that nothing of ours stands in
# a foreign program's way; where they name each other, likewise. Fails if one includes a header that is not public.
#   cmake -DROOT=... -DTO=... -DHEADERS=pvs/pvs_file.h|api/bake.h -P public_headers.cmake
string(REPLACE "|" ";" headers "${HEADERS}")
foreach(header ${headers})
  file(READ ${ROOT}/core/${header} text)
  foreach(other ${headers})
    string(REPLACE core/${other} sightline/${other} text "${text}")
  endforeach()
  if(text MATCHES "#include \"(core|bvh)/[^\"]*\"")
    message(FATAL_ERROR "core/${header} is public, but not what it has: ${CMAKE_MATCH_0} (cmake/install.cmake)")
  endif()
  file(WRITE ${TO}/sightline/${header} "${text}")
endforeach()
