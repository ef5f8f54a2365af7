// nearfield_content OUT_DIR: writes the bundled scenes. Run by the build.
#include <cstdio>
#include <filesystem>

#include "core/error.h"
#include "image/file.h"
#include "scenes.h"
#include "sky.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: nearfield_content OUT_DIR\n");
    return int(nf::Exit::Usage);
  }
  try {
    const std::filesystem::path folder = argv[1];
    std::error_code ignored;  // a folder that cannot be made is reported by the writing
    std::filesystem::create_directories(folder, ignored);
    nf::image::write_file(folder / "cornell.glb", nf::content::cornell());
    nf::image::write_file(folder / "fence.glb", nf::content::fence());
    nf::image::write_file(folder / "furnace.glb", nf::content::furnace());
    nf::image::write_file(folder / "atrium.glb", nf::content::atrium());
    const std::string view = nf::content::atrium_view();
    nf::image::write_file(folder / "atrium.json", {reinterpret_cast<const uint8_t*>(view.data()), view.size()});
    const nf::image::Layer sky{"", "RGB", nf::content::sky_map(nf::content::afternoon(), 1024)};
    nf::image::write_exr(folder / "sky.exr", {&sky, 1}, {}, nf::image::Precision::Half);
  } catch (const nf::Error& e) {
    std::fprintf(stderr, "error: %s\n", e.what());
    return int(e.exit());
  }
  return 0;
}
