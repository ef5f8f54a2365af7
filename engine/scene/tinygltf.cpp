// The body of the header-only tinygltf; CMakeLists.txt says why it is not the shared library's.
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
