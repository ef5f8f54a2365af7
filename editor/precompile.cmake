# A step of `cmake --install`: the window runs once without a display, each technique in turn, and the SPIR-V that this
# left in an empty cache goes into share/nearfield/spirv, where the installed program finds it (gpu::shipped_spirv).
# Where there is no Vulkan device nothing is put there, and programs are compiled when they are first used.
set(prefix "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}")
set(work "${NF_BUILD_DIR}/precompile")
file(REMOVE_RECURSE "${work}")
set(script "{\"wait\": \"scene_frames >= 1\"}\n")
foreach(technique RANGE 8)
  string(APPEND script "{\"key\": \"n\"}\n{\"wait\": \"scene_frames_since_change >= 2\"}\n")
endforeach()
file(WRITE "${work}/script.jsonl" "${script}")
execute_process(
  COMMAND ${CMAKE_COMMAND} -E env --unset=NEARFIELD_DATA_DIR "XDG_CACHE_HOME=${work}" "XDG_CONFIG_HOME=${work}"
          "${prefix}/bin/nearfield" edit "${prefix}/share/nearfield/content/cornell.glb" --offscreen --window 640x360
          --ui-script "${work}/script.jsonl"
  WORKING_DIRECTORY "${work}" OUTPUT_QUIET ERROR_VARIABLE fault RESULT_VARIABLE failed)
if(failed)
  message(STATUS "Shaders are not precompiled: ${fault}")
  return()
endif()
file(GLOB programs "${work}/nearfield/spirv/*.spv")
file(INSTALL ${programs} DESTINATION "${CMAKE_INSTALL_PREFIX}/share/nearfield/spirv")
