# Writes each of FILES (separated by "|") as the array of bytes behind a std::string_view of NAMES (parts.h).
cmake_minimum_required(VERSION 3.25)
string(REPLACE "|" ";" files "${FILES}")
string(REPLACE "|" ";" names "${NAMES}")
set(text "#include \"core/page/parts/parts.h\"\nnamespace sightline {\n")
foreach(file name IN ZIP_LISTS files names)
  file(READ ${file} digits HEX)
  string(REGEX REPLACE "(................................)" "\\1\n" digits "${digits}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${digits}")
  string(APPEND text "namespace {\nconstexpr char ${name}Bytes[] = {\n${bytes}};\n}\n"
                     "const std::string_view ${name}(${name}Bytes, sizeof(${name}Bytes));\n")
endforeach()
file(WRITE ${OUTPUT} "${text}}\n")
