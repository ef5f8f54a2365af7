// Camera rays per second of the path tracer next to a plain Embree loop over the same rays, and of its whole walks.
// Prints figures; no test. reference_rays SCENE [VIEW] [WIDTHxHEIGHT]
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <functional>

#include "core/error.h"
#include "reference/paths.h"
#include "scene/gltf.h"
#include "scene/view.h"

namespace {

using namespace nf;

// Of this thread: what else runs on the machine does not count.
double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

void skip_holes(const RTCFilterFunctionNArguments* args) {
  const auto* world = static_cast<const reference::World*>(args->geometryUserPtr);
  for (unsigned int i = 0; i < args->N; ++i)
    if (args->valid[i] != 0 && world->hole(RTCHitN_geomID(args->hit, args->N, i), RTCHitN_primID(args->hit, args->N, i),
                                           RTCHitN_u(args->hit, args->N, i), RTCHitN_v(args->hit, args->N, i)))
      args->valid[i] = 0;
}

// Triangles and nothing else: no culling, and no cut-outs unless asked for.
RTCScene plain_scene(RTCDevice device, const reference::World& world, bool robust, bool holes = false) {
  RTCScene scene = rtcNewScene(device);
  if (robust) rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  for (const reference::WorldInstance& instance : world.instances()) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, instance.position.data(), 0, 12,
                               instance.position.size() - 1);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               world.scene().geometry.index.data() + instance.primitive->first_index, 0, 12,
                               instance.primitive->index_count / 3);
    if (holes && instance.masked) {
      rtcSetGeometryUserData(geometry, const_cast<reference::World*>(&world));
      rtcSetGeometryIntersectFilterFunction(geometry, skip_holes);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene);
  return scene;
}

// A way to trace the rays; returns how many hit.
struct Contender {
  const char* name;
  std::function<size_t()> run;
  double best = 1e30;
  size_t hits = 0;
};

// Best of some rounds in which all take their turn, so that whatever else the machine does meets all alike.
void race(std::vector<Contender>& contenders, size_t rays) {
  for (int round = 0; round < 15; ++round) {
    for (Contender& c : contenders) {
      const double start = cpu_seconds();
      c.hits = c.run();
      c.best = std::min(c.best, cpu_seconds() - start);
    }
  }
  for (const Contender& c : contenders)
    fmt::print("{:44} {:8.3f} million rays/s  {:5.2f} of the first  ({} of {} hit)\n", c.name,
               double(rays) / c.best / 1e6, contenders.front().best / c.best, c.hits, rays);
}

size_t plain_loop(RTCScene scene, const std::vector<reference::Ray>& rays) {
  size_t hits = 0;
  for (const reference::Ray& ray : rays) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query{};
    query.ray.org_x = ray.origin.x, query.ray.org_y = ray.origin.y, query.ray.org_z = ray.origin.z;
    query.ray.dir_x = ray.direction.x, query.ray.dir_y = ray.direction.y, query.ray.dir_z = ray.direction.z;
    query.ray.tnear = ray.near, query.ray.tfar = ray.far, query.ray.mask = ~0u;
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &query);
    hits += query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  }
  return hits;
}

void run(int argc, char** argv) {
  scene::Scene scene = scene::load_gltf(argv[1]);
  reference::Settings settings;
  settings.camera = scene::select_view(argc > 2 ? argv[2] : "", scene);
  settings.size = {640, 360};
  if (argc > 3) std::sscanf(argv[3], "%ux%u", &settings.size.x, &settings.size.y);
  settings.lambert = true;
  settings.threads = 1;
  const reference::World world(scene, {.lambert = true});
  const reference::Rays rays(world);
  const reference::Lights lights(world);
  const reference::Integrator integrator{world, rays, lights, settings, {}};
  std::vector<reference::Ray> camera_rays;
  for (uint32_t y = 0; y < settings.size.y; ++y)
    for (uint32_t x = 0; x < settings.size.x; ++x)
      camera_rays.push_back(reference::camera_ray(settings, glm::vec2(x, y) + 0.5f));
  RTCDevice device = rtcNewDevice("threads=1");
  const RTCScene plain = plain_scene(device, world, false), robust = plain_scene(device, world, true),
                 holes = plain_scene(device, world, true, true);
  const auto hits_of = [&](const auto& trace) {
    return [&camera_rays, trace] {
      size_t hits = 0;
      for (const reference::Ray& ray : camera_rays) hits += trace(ray);
      return hits;
    };
  };
  uint64_t count = 0;
  std::vector<Contender> contenders;
  contenders.push_back({"plain loop", [&] { return plain_loop(plain, camera_rays); }});
  contenders.push_back({"plain loop, robust", [&] { return plain_loop(robust, camera_rays); }});
  contenders.push_back({"plain loop, robust, cut-outs", [&] { return plain_loop(holes, camera_rays); }});
  contenders.push_back({"Rays::closest (cut-outs)", hits_of([&](const auto& ray) { return rays.closest(ray).any(); })});
  contenders.push_back(
      {"Rays::closest_seen (cut-outs, backs)", hits_of([&](const auto& ray) { return rays.closest_seen(ray).any(); })});
  contenders.push_back({"first_hit (with the surface)",
                        hits_of([&](const auto& ray) { return reference::first_hit(integrator, ray, count).hit; })});
  race(contenders, camera_rays.size());
  rtcReleaseScene(plain);
  rtcReleaseScene(robust);
  rtcReleaseScene(holes);
  rtcReleaseDevice(device);
  for (const char* layer : {"visibility", "gi_1", "gi_4"}) {
    reference::Tracer tracer(scene, settings, reference::parse_layers(layer, 4));
    const double start = cpu_seconds();
    tracer.sample(2);
    fmt::print("{:44} {:8.3f} million rays/s\n", fmt::format("Tracer, R,G,B and {}", layer),
               double(tracer.rays()) / (cpu_seconds() - start) / 1e6);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: reference_rays SCENE [VIEW] [WIDTHxHEIGHT]\n");
    return 2;
  }
  try {
    run(argc, argv);
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
