// Compiles GLSL text as C++ over GLM, so that tests run the very functions that the GPU runs. Use:
//   NF_GLSL_BEGIN
//   #include "common/slice.glsl"
//   NF_GLSL_END
// and find them in namespace `twin`. One translation unit of a program may include a given file.
#pragma once

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/integer.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#define INOUT(type) type&

// GLSL converts int to float and the like where C++ warns.
#define NF_GLSL_BEGIN                                                               \
  _Pragma("GCC diagnostic push") _Pragma("GCC diagnostic ignored \"-Wconversion\"") \
      _Pragma("GCC diagnostic ignored \"-Wshadow\"")                                \
          _Pragma("GCC diagnostic ignored \"-Wunused-function\"") namespace twin {  \
    using namespace glm;
#define NF_GLSL_END \
  }                 \
  _Pragma("GCC diagnostic pop")
