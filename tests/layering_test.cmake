# The layering of the rooms, enforced: engine <- passes <- editor, and inside the engine the tables below. Run by ctest
# (tests/cmake/layering.cmake):
#   cmake -DROOT=... -DWORK=... -DCXX=... -DENGINE_INCLUDES=a|b -DPASSES_INCLUDES=a|b -DDEFINES=A|B -P layering_test.cmake
# Without CXX only the sources are scanned, not compiled.
cmake_minimum_required(VERSION 3.25)

# --- the rules ---
# room: rooms whose headers it may include.
set(may_include_core core)
set(may_include_image core image)
set(may_include_scene core image scene)
set(may_include_gpu core gpu)
set(may_include_graph core gpu graph)
set(may_include_capture core capture)
set(may_include_reference core image scene reference)
set(may_include_vulkan_header engine/gpu/ engine/graph/)
set(may_emit_barriers engine/graph/execute.cpp engine/gpu/upload.cpp engine/gpu/frame_ring.cpp engine/gpu/swapchain.cpp)
# Pure functions of the graph; files that are not there are passed over.
set(must_not_call_vulkan engine/graph/graph.cpp engine/graph/access.cpp engine/graph/validate.cpp engine/graph/compile.cpp
    engine/graph/place.cpp engine/graph/hazards.cpp engine/graph/dump.cpp)

# --- the scan ---
function(violation text)
  string(REPLACE ";" ", " text "${text}")
  set_property(GLOBAL APPEND PROPERTY violations "${text}")
endfunction()

# Whether a file may include `path`, which was written in quotes or angle brackets (`quoted`).
function(check_include root file path quoted)
  if(path MATCHES "(^|/)\\.\\./")
    violation("${file} includes \"${path}\": includes start at engine/, passes/ or editor/, never at '..'")
    return()
  endif()
  if(path MATCHES "^vulkan/")
    foreach(prefix ${may_include_vulkan_header})
      if(file MATCHES "^${prefix}")
        return()
      endif()
    endforeach()
    violation("${file} includes <${path}>: only ${may_include_vulkan_header} may; include \"gpu/...\" or \"graph/...\" instead")
    return()
  endif()

  if(file MATCHES "^engine/([^/]+)/")
    set(room ${CMAKE_MATCH_1})
    if(NOT DEFINED may_include_${room})
      violation("${file}: the room engine/${room} has no row in tests/layering_test.cmake; add may_include_${room}")
    elseif(EXISTS "${root}/engine/${path}")
      string(REGEX REPLACE "/.*" "" target "${path}")
      if(NOT target IN_LIST may_include_${room})
        violation("${file} includes \"${path}\": engine/${room} may include only: ${may_include_${room}}")
      endif()
    elseif(EXISTS "${root}/passes/${path}" OR EXISTS "${root}/editor/${path}")
      violation("${file} includes \"${path}\" of passes/ or editor/: the engine knows neither")
    elseif(quoted)
      violation("${file} includes \"${path}\": there is no engine/${path}; write \"room/header.h\" for our own, <...> for others")
    endif()
  elseif(file MATCHES "^passes/")
    if(NOT EXISTS "${root}/passes/${path}" AND NOT EXISTS "${root}/engine/${path}" AND EXISTS "${root}/editor/${path}")
      violation("${file} includes \"${path}\" of editor/: passes do not know the editor")
    endif()
  endif()
endfunction()

function(scan_file root file)
  file(STRINGS "${root}/${file}" lines REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"]")
  foreach(line ${lines})
    if(line MATCHES "#[ \t]*include[ \t]*([<\"])([^>\"]+)[>\"]")
      set(path "${CMAKE_MATCH_2}")
      if(CMAKE_MATCH_1 STREQUAL "<")
        check_include("${root}" "${file}" "${path}" FALSE)
      else()
        check_include("${root}" "${file}" "${path}" TRUE)
      endif()
    endif()
  endforeach()

  # Comments may name a function; code may not.
  file(READ "${root}/${file}" text)
  string(REGEX REPLACE "//[^\n]*" "" text "${text}")
  if(text MATCHES "vkCmdPipelineBarrier" AND NOT file IN_LIST may_emit_barriers)
    violation("${file} calls vkCmdPipelineBarrier: barriers are emitted only in ${may_emit_barriers}")
  endif()
  if(file IN_LIST must_not_call_vulkan AND text MATCHES "[^A-Za-z0-9_](vk[A-Z][A-Za-z0-9]*)[ \t\n]*\\(")
    violation("${file} calls ${CMAKE_MATCH_1}: it must work without a device")
  endif()
endfunction()

# Sets `out` to the list of what is wrong in the tree at `root`.
function(scan root out)
  set_property(GLOBAL PROPERTY violations "")
  file(GLOB_RECURSE files RELATIVE "${root}" "${root}/engine/*.h" "${root}/engine/*.cpp" "${root}/passes/*.h" "${root}/passes/*.cpp"
       "${root}/editor/*.h" "${root}/editor/*.cpp")
  foreach(file ${files})
    scan_file("${root}" "${file}")
  endforeach()
  get_property(found GLOBAL PROPERTY violations)
  set(${out} "${found}" PARENT_SCOPE)
endfunction()

# --- the scan notices what it must: a small tree with one violation a file ---
set(bad "${WORK}/bad_tree")
file(REMOVE_RECURSE "${bad}")
file(WRITE "${bad}/engine/core/error.h" "// Comments may say vkCmdPipelineBarrier2(x) and #include \"frame.h\".\n#include <string>\n")
file(WRITE "${bad}/engine/gpu/device.h" "#include <vulkan/vulkan.h>\n#include \"core/error.h\"\n")
file(WRITE "${bad}/engine/graph/execute.cpp" "void f() { vkCmdPipelineBarrier2(0, 0); }\n")
file(WRITE "${bad}/passes/frame.h" "#include \"gpu/device.h\"\n")
file(WRITE "${bad}/editor/cli/options.h" "#include \"frame.h\"\n")
scan("${bad}" found)
if(found)
  message(FATAL_ERROR "the scan finds fault with a good tree: ${found}")
endif()
set(expected 0)
foreach(row
    "engine/core/a.h|#include \"gpu/device.h\"" "engine/scene/b.cpp|#include <gpu/device.h>" "engine/gpu/c.cpp|  #  include \"frame.h\""
    "engine/graph/d.h|#include \"cli/options.h\"" "engine/core/e.h|#include \"../../passes/frame.h\"" "engine/core/f.h|#include \"error.h\""
    "engine/new_room/g.h|#include \"core/error.h\"" "engine/core/h.h|#include <vulkan/vulkan.h>" "passes/i.h|#include <vulkan/vulkan_core.h>"
    "passes/gi/j.cpp|#include \"cli/options.h\"" "passes/k.cpp|void f() { vkCmdPipelineBarrier2(0, 0) }"
    "engine/graph/compile.cpp|int x = vkDeviceWaitIdle (0)")
  string(REPLACE "|" ";" row "${row}")
  list(GET row 0 file)
  list(GET row 1 text)
  file(WRITE "${bad}/${file}" "\n${text}\n")
  scan("${bad}" found)
  list(LENGTH found count)
  if(NOT count EQUAL 1)
    message(FATAL_ERROR "the scan must find one violation in ${file} (${text}), it found ${count}: ${found}")
  endif()
  file(REMOVE "${bad}/${file}")
endforeach()

# --- the tree itself ---
scan("${ROOT}" found)
foreach(text ${found})
  message(SEND_ERROR "layering: ${text}")
endforeach()
foreach(file engine/graph/graph.cpp engine/graph/validate.cpp engine/graph/compile.cpp ${may_emit_barriers})
  if(NOT EXISTS "${ROOT}/${file}")
    message(SEND_ERROR "tests/layering_test.cmake speaks of ${file}, which is gone: bring its tables up to date")
  endif()
endforeach()

# --- and the compiler agrees: with a target's own include folders, a header of a room above it is not found ---
# try(NAME includes header expected): expected is COMPILES, or MISSING when the header must not be found.
function(try name includes header expected)
  set(source "${WORK}/${name}.cpp")
  file(WRITE "${source}" "#include \"${header}\"\n")
  string(REPLACE "|" ";" includes "${includes}")
  list(REMOVE_DUPLICATES includes)
  list(REMOVE_ITEM includes "" /usr/include)
  list(TRANSFORM includes PREPEND -I)
  string(REPLACE "|" ";" defines "${DEFINES}")
  list(REMOVE_DUPLICATES defines)
  list(REMOVE_ITEM defines "")
  list(TRANSFORM defines PREPEND -D)
  execute_process(COMMAND "${CXX}" -std=c++20 -fsyntax-only ${defines} ${includes} "${source}"
                  WORKING_DIRECTORY "${WORK}" RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(expected STREQUAL "COMPILES" AND NOT result EQUAL 0)
    message(SEND_ERROR "layering: a file of ${name} must be able to include \"${header}\", but:\n${output}")
  elseif(expected STREQUAL "MISSING" AND result EQUAL 0)
    message(SEND_ERROR "layering: a file of ${name} can include \"${header}\", a header of a room above it: look at the include folders in CMakeLists.txt")
  elseif(expected STREQUAL "MISSING" AND NOT output MATCHES "${header}[^\n]*(No such file|file not found)")
    message(SEND_ERROR "layering: \"${header}\" in ${name} fails to compile for another reason than being out of reach:\n${output}")
  endif()
endfunction()

if(CXX)
  try(engine "${ENGINE_INCLUDES}" core/error.h COMPILES)
  try(engine_of_passes "${ENGINE_INCLUDES}" frame.h MISSING)
  try(engine_of_editor "${ENGINE_INCLUDES}" cli/options.h MISSING)
  try(passes "${PASSES_INCLUDES}" frame.h COMPILES)
  try(passes_of_editor "${PASSES_INCLUDES}" cli/options.h MISSING)
endif()
