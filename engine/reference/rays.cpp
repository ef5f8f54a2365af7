// One Embree geometry an instance; its number is the instance's row.
#include "reference/rays.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <embree3/rtcore.h>
#include <tuple>

#include "core/error.h"
#include "reference/sampler.h"

namespace nf::reference {
namespace {

enum class Kind : uint8_t { Any, Seen, Shadow };

struct Context {
  RTCIntersectContext base;
  const World* world;
  Kind kind = Kind::Any;
  float open = 1;                       // Shadow: what the blended surfaces so far let through
  Hit last;                             // Shadow: the one before
  std::vector<Hit>* blended = nullptr;  // Seen: those that were passed
};

bool is_back(const WorldInstance& instance, const RTCFilterFunctionNArguments* args, unsigned int i) {
  if (instance.material->double_sided) return false;
  const vec3 normal(RTCHitN_Ng_x(args->hit, args->N, i), RTCHitN_Ng_y(args->hit, args->N, i),
                    RTCHitN_Ng_z(args->hit, args->N, i));
  const vec3 direction(RTCRayN_dir_x(args->ray, args->N, i), RTCRayN_dir_y(args->ray, args->N, i),
                       RTCRayN_dir_z(args->ray, args->N, i));
  return glm::dot(normal, direction) * instance.mirrored > 0;
}

// In [0, 1), of the ray and what it meets: the same wherever and whenever it is traced.
float chance(const RTCFilterFunctionNArguments* args, unsigned int i, const Hit& hit) {
  uint64_t key = uint64_t(hit.instance) << 32 | hit.triangle;
  for (const float value : {RTCRayN_org_x(args->ray, args->N, i), RTCRayN_org_y(args->ray, args->N, i),
                            RTCRayN_org_z(args->ray, args->N, i), RTCRayN_dir_x(args->ray, args->N, i),
                            RTCRayN_dir_y(args->ray, args->N, i), RTCRayN_dir_z(args->ray, args->N, i)})
    key = mix(key ^ std::bit_cast<uint32_t>(value));
  return float(key >> 40) * 0x1p-24f;
}

// On the edge between two triangles a ray meets both, one after the other.
bool is_same_point(const Hit& a, const Hit& b) {
  return a.instance == b.instance && std::abs(a.t - b.t) <= 1e-5f * a.t;
}

// Both filters: a hit that does not count is undone by setting valid to 0.
void filter_alpha(const RTCFilterFunctionNArguments* args) {
  Context& context = *reinterpret_cast<Context*>(args->context);
  const World& world = *context.world;
  for (unsigned int i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    const Hit hit{RTCHitN_geomID(args->hit, args->N, i), RTCHitN_primID(args->hit, args->N, i),
                  RTCRayN_tfar(args->ray, args->N, i), RTCHitN_u(args->hit, args->N, i),
                  RTCHitN_v(args->hit, args->N, i)};
    const WorldInstance& instance = world.instances()[hit.instance];
    if (!instance.blended) {
      if (world.hole(hit.instance, hit.triangle, hit.u, hit.v)) args->valid[i] = 0;
      continue;
    }
    const float alpha = world.alpha(hit.instance, hit.triangle, hit.u, hit.v);
    bool counts = false;
    if (context.kind == Kind::Any) counts = chance(args, i, hit) < alpha;
    if (context.kind == Kind::Shadow && !is_same_point(hit, context.last)) {
      context.last = hit;
      context.open *= 1 - std::clamp(alpha, 0.0f, 1.0f);
      counts = context.open == 0;
    }
    if (context.kind == Kind::Seen && context.blended && alpha > 0 && !is_back(instance, args, i))
      context.blended->push_back(hit);
    if (!counts) args->valid[i] = 0;
  }
}

void skip_backs(const RTCFilterFunctionNArguments* args) {
  const World& world = *reinterpret_cast<const Context*>(args->context)->world;
  for (unsigned int i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    if (is_back(world.instances()[RTCHitN_geomID(args->hit, args->N, i)], args, i)) args->valid[i] = 0;
  }
}

void fill(RTCRay& to, const Ray& ray) {
  to.org_x = ray.origin.x, to.org_y = ray.origin.y, to.org_z = ray.origin.z;
  to.dir_x = ray.direction.x, to.dir_y = ray.direction.y, to.dir_z = ray.direction.z;
  to.tnear = ray.near, to.tfar = ray.far;
  to.time = 0, to.mask = ~0u, to.id = 0, to.flags = 0;
}

Hit trace(RTCScene scene, Context& context, const Ray& ray) {
  RTCRayHit query;
  fill(query.ray, ray);
  query.hit.geomID = query.hit.primID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene, &context.base, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return {query.hit.geomID, query.hit.primID, query.ray.tfar, query.hit.u, query.hit.v};
}

}  // namespace

std::string backend() {
  return "CPU, Embree " RTC_VERSION_STRING;
}

struct Rays::State {
  explicit State(const World& of) : world(of) {}
  const World& world;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  ~State() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

Rays::Rays(const World& world, const std::atomic<bool>* cancel) : state_(std::make_unique<State>(world)) {
  // One thread builds, so that the tree, and with it the choice among equally near surfaces, is always the same.
  state_->device = rtcNewDevice("threads=1,set_affinity=0");
  if (!state_->device) fail(Exit::Internal, "Embree does not start: error {}", int(rtcGetDeviceError(nullptr)));
  RTCDevice device = state_->device;
  state_->scene = rtcNewScene(device);
  rtcSetSceneFlags(state_->scene, RTCSceneFlags(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  const std::vector<uint32_t>& index = world.scene().geometry.index;
  for (uint32_t row = 0; row < world.instances().size(); ++row) {
    const WorldInstance& instance = world.instances()[row];
    if (instance.primitive->index_count < 3) continue;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, instance.position.data(), 0,
                               sizeof(vec3), instance.position.size() - 1);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               index.data() + instance.primitive->first_index, 0, 3 * sizeof(uint32_t),
                               instance.primitive->index_count / 3);
    if (instance.masked || instance.blended) {
      rtcSetGeometryIntersectFilterFunction(geometry, filter_alpha);
      rtcSetGeometryOccludedFilterFunction(geometry, filter_alpha);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(state_->scene, geometry, row);
    rtcReleaseGeometry(geometry);
  }
  if (cancel)
    rtcSetSceneProgressMonitorFunction(
        state_->scene, [](void* flag, double) { return !*static_cast<const std::atomic<bool>*>(flag); },
        const_cast<std::atomic<bool>*>(cancel));
  rtcCommitScene(state_->scene);
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_CANCELLED || (cancel && *cancel)) throw Cancelled();
  if (error == RTC_ERROR_OUT_OF_MEMORY) fail(Exit::Gpu, "out of memory: the ray structure of the scene does not fit");
  NF_CHECK(error == RTC_ERROR_NONE, "Embree error {}", int(error));
}

Rays::~Rays() = default;

Hit Rays::closest(const Ray& ray) const {
  Context context{{}, &state_->world, Kind::Any};
  rtcInitIntersectContext(&context.base);
  return trace(state_->scene, context, ray);
}

Hit Rays::closest_seen(const Ray& ray, std::vector<Hit>* blended) const {
  Context context{{}, &state_->world, Kind::Seen, 1, {}, blended};
  rtcInitIntersectContext(&context.base);
  context.base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  context.base.filter = skip_backs;
  const Hit hit = trace(state_->scene, context, ray);
  if (blended) {
    std::erase_if(*blended, [&](const Hit& b) { return hit.any() && b.t >= hit.t; });
    std::sort(blended->begin(), blended->end(), [](const Hit& a, const Hit& b) {
      return std::tie(a.t, a.instance, a.triangle) < std::tie(b.t, b.instance, b.triangle);
    });
    blended->erase(std::unique(blended->begin(), blended->end(), is_same_point), blended->end());
  }
  return hit;
}

float Rays::open(const Ray& ray) const {
  Context context{{}, &state_->world, Kind::Shadow};
  rtcInitIntersectContext(&context.base);
  RTCRay query;
  fill(query, ray);
  rtcOccluded1(state_->scene, &context.base, &query);
  return query.tfar < 0 ? 0 : context.open;
}

}  // namespace nf::reference
