#include "core/crossings/ray_caster.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <dlfcn.h>

#include <algorithm>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>

#include "core/machine/floating_point.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// The monotone map of one axis from double to Embree's float: [lower - size, upper + size] to [1, 2], what lies outside
// clamped. Boxes and ray origins go through the same map, so that rounding cannot part them. All is scaled by 1/8
// first, lest sizes overflow.
struct AxisMap {
  double lower = 0.0;
  double width = 0.0;

  AxisMap(double mesh_lower, double mesh_upper)
      : lower(mesh_lower / 8 - (mesh_upper / 8 - mesh_lower / 8)), width(3.0 * (mesh_upper / 8 - mesh_lower / 8)) {}

  [[nodiscard]] float operator()(double x) const {
    if (!(width > 0.0)) return 1.5F;  // a flat axis tells nothing apart
    return static_cast<float>(1.0 + std::clamp((x / 8 - lower) / width, 0.0, 1.0));
  }
};

// Boxes are enlarged by four units in the last place of [1, 2]: for a direction with zero components Embree drops boxes
// whose face contains the ray (measured: 1.3 % of the candidates of a degenerate lattice with one unit, none with
// four).
constexpr float kSlack = 4.0F * 0x1p-23F;

// The address of a function, as a pointer of any type to one.
struct Address {
  void* address;
  template <class Function>
  operator Function*() const {
    return reinterpret_cast<Function*>(address);
  }
};

// Embree's library, which stays loaded to the end, and what is used of it. It is loaded when the first mesh needs it:
// that takes a third of the time in which the executable starts, and all ways but RayEngine::kEmbree do without.
class Embree {
  void* library_ = dlopen(RAYCONE_EMBREE_FILE, RTLD_LAZY | RTLD_LOCAL);

  [[nodiscard]] Address function(const char* name) const {
    void* const address = library_ ? dlsym(library_, name) : nullptr;
    if (!address) throw EmbreeUnavailable(std::string("cannot load Embree: ") + dlerror());
    return {address};
  }

 public:
  decltype(::rtcNewDevice)* rtcNewDevice = function("rtcNewDevice");
  decltype(::rtcReleaseDevice)* rtcReleaseDevice = function("rtcReleaseDevice");
  decltype(::rtcGetDeviceError)* rtcGetDeviceError = function("rtcGetDeviceError");
  decltype(::rtcNewScene)* rtcNewScene = function("rtcNewScene");
  decltype(::rtcReleaseScene)* rtcReleaseScene = function("rtcReleaseScene");
  decltype(::rtcSetSceneFlags)* rtcSetSceneFlags = function("rtcSetSceneFlags");
  decltype(::rtcCommitScene)* rtcCommitScene = function("rtcCommitScene");
  decltype(::rtcNewGeometry)* rtcNewGeometry = function("rtcNewGeometry");
  decltype(::rtcReleaseGeometry)* rtcReleaseGeometry = function("rtcReleaseGeometry");
  decltype(::rtcSetGeometryUserPrimitiveCount)* rtcSetGeometryUserPrimitiveCount =
      function("rtcSetGeometryUserPrimitiveCount");
  decltype(::rtcSetGeometryUserData)* rtcSetGeometryUserData = function("rtcSetGeometryUserData");
  decltype(::rtcSetGeometryBoundsFunction)* rtcSetGeometryBoundsFunction = function("rtcSetGeometryBoundsFunction");
  decltype(::rtcSetGeometryOccludedFunction)* rtcSetGeometryOccludedFunction =
      function("rtcSetGeometryOccludedFunction");
  decltype(::rtcCommitGeometry)* rtcCommitGeometry = function("rtcCommitGeometry");
  decltype(::rtcAttachGeometry)* rtcAttachGeometry = function("rtcAttachGeometry");
  decltype(::rtcOccluded1)* rtcOccluded1 = function("rtcOccluded1");
};

const Embree& embree() {
  static const Embree loaded;
  return loaded;
}

void throw_on_error(RTCDevice device) {
  const RTCError error = embree().rtcGetDeviceError(device);
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE) throw std::runtime_error("Embree error " + std::to_string(static_cast<int>(error)));
}

}  // namespace

struct RayCaster::Scene {
  const TriangleMesh& mesh;
  AxisMap x, y, z;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  Scene(const TriangleMesh& m, const Box& box)
      : mesh(m), x(box.lower.x, box.upper.x), y(box.lower.y, box.upper.y), z(box.lower.z, box.upper.z) {}
  ~Scene() {
    if (scene) embree().rtcReleaseScene(scene);
    if (device) embree().rtcReleaseDevice(device);
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  void build();
  static void bounds(const RTCBoundsFunctionArguments* args);
};

namespace {

// The query context, extended by where candidates go.
#if RTC_VERSION_MAJOR >= 4
struct CandidateContext : RTCRayQueryContext {
#else
struct CandidateContext : RTCIntersectContext {
#endif
  std::vector<std::uint32_t>* candidates = nullptr;
  bool is_complete = true;  // memory did not run out
};

// Reports no hit, so that the traversal goes on to every box along the ray. Embree's interface is one of C: no
// exception may pass it.
void collect(const RTCOccludedFunctionNArguments* args) noexcept {
  if (args->valid[0] == 0) return;
  auto& context = *static_cast<CandidateContext*>(args->context);
  try {
    context.candidates->push_back(args->primID);
  } catch (...) {  // of memory or of length
    context.is_complete = false;
  }
}

void occluded(RTCScene scene, RTCRay& ray, CandidateContext& context) {
#if RTC_VERSION_MAJOR >= 4
  rtcInitRayQueryContext(&context);
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.context = &context;
  embree().rtcOccluded1(scene, &ray, &arguments);
#else
  rtcInitIntersectContext(&context);
  embree().rtcOccluded1(scene, &context, &ray);
#endif
}

}  // namespace

void RayCaster::Scene::bounds(const RTCBoundsFunctionArguments* args) {
  const DefaultFloatingPoint guard;
  const Scene& self = *static_cast<const Scene*>(args->geometryUserPtr);
  const Triangle& t = self.mesh.triangles[args->primID];
  const Vec3 &a = self.mesh.vertices[t[0]], &b = self.mesh.vertices[t[1]], &c = self.mesh.vertices[t[2]];
  RTCBounds& box = *args->bounds_o;
  box.lower_x = self.x(std::min({a.x, b.x, c.x})) - kSlack;
  box.lower_y = self.y(std::min({a.y, b.y, c.y})) - kSlack;
  box.lower_z = self.z(std::min({a.z, b.z, c.z})) - kSlack;
  box.upper_x = self.x(std::max({a.x, b.x, c.x})) + kSlack;
  box.upper_y = self.y(std::max({a.y, b.y, c.y})) + kSlack;
  box.upper_z = self.z(std::max({a.z, b.z, c.z})) + kSlack;
}

void RayCaster::Scene::build() {
  prime_threads();
  const Embree& api = embree();
  const DefaultFloatingPoint guard;  // rtcCommitScene leaves flush-to-zero behind
  device = api.rtcNewDevice(nullptr);
  if (!device) throw_on_error(nullptr);
  scene = api.rtcNewScene(device);
  api.rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = api.rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  api.rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(mesh.triangles.size()));
  api.rtcSetGeometryUserData(geometry, this);
  api.rtcSetGeometryBoundsFunction(geometry, &Scene::bounds, nullptr);
  api.rtcSetGeometryOccludedFunction(geometry, &collect);
  api.rtcCommitGeometry(geometry);
  api.rtcAttachGeometry(scene, geometry);
  api.rtcReleaseGeometry(geometry);
  isolated([&] { api.rtcCommitScene(scene); });
  throw_on_error(device);
}

RayCaster::RayCaster(const TriangleMesh& mesh) {
  auto scene = std::make_unique<Scene>(mesh, bounding_box(mesh));
  scene->build();
  scene_ = std::move(scene);
}
RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;

void RayCaster::find_candidates(const Vec3& origin, std::vector<std::uint32_t>& candidates) const {
  candidates.clear();
  CandidateContext context;
  context.candidates = &candidates;
  RTCRay ray{};
  ray.org_x = scene_->x(origin.x);
  ray.org_y = scene_->y(origin.y);
  ray.org_z = scene_->z(origin.z);
  ray.dir_x = 1.0F;
  ray.tfar = std::numeric_limits<float>::infinity();
  ray.mask = ~0U;
  occluded(scene_->scene, ray, context);
  if (!context.is_complete) throw std::bad_alloc();
}

}  // namespace raycone
