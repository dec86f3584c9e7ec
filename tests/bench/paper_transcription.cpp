#include "tests/bench/paper_transcription.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "core/machine/threads.h"

namespace raycone::bench {
namespace {

struct ExteriorEdge {
  Vec3 from;
  Vec3 to;
  double multiplicity;
};

struct Crossing {
  float x;
  int sign;
};

#if RTC_VERSION_MAJOR >= 4
using RayContext = RTCRayQueryContext;
#else
using RayContext = RTCIntersectContext;
#endif

// What the intersection filter finds behind the context that it is given.
struct CrossingContext {
  RayContext context;  // first, so that a pointer to it is one to the whole
  std::vector<Crossing>* crossings;
};

// Records the hit and lets the ray go on.
void record_crossing(const RTCFilterFunctionNArguments* arguments) {
  if (arguments->valid[0] == 0) return;
  arguments->valid[0] = 0;
  auto& crossings = *reinterpret_cast<CrossingContext*>(arguments->context)->crossings;
  const float x = RTCRayN_org_x(arguments->ray, 1, 0) + RTCRayN_tfar(arguments->ray, 1, 0);
  crossings.push_back({x, RTCHitN_Ng_x(arguments->hit, 1, 0) > 0.0F ? 1 : -1});
}

std::vector<ExteriorEdge> find_exterior_edges(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> net_count;
  for (const Triangle& triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = triangle[i];
      const std::uint32_t to = triangle[(i + 1) % 3];
      if (from < to) ++net_count[{from, to}];
      if (to < from) --net_count[{to, from}];
    }
  }
  std::vector<ExteriorEdge> edges;
  for (const auto& [ends, count] : net_count) {
    if (count != 0) edges.push_back({mesh.vertices[ends.first], mesh.vertices[ends.second], double(count)});
  }
  return edges;
}

// |p| - p_x without cancellation.
double distance_behind(const Vec3& p) {
  const double across = p.y * p.y + p.z * p.z;
  const double length = std::sqrt(p.x * p.x + across);
  return p.x > 0.0 ? across / (length + p.x) : length - p.x;
}

// Winding number of the cone over the edges, seen from q.
double cone_winding_number(const std::vector<ExteriorEdge>& edges, const Vec3& q) {
  double sum = 0.0;
  for (const ExteriorEdge& edge : edges) {
    const Vec3 a = edge.from - q;
    const Vec3 b = edge.to - q;
    const double real = distance_behind(a) * distance_behind(b) + a.y * b.y + a.z * b.z;
    const double imaginary = a.y * b.z - a.z * b.y;
    sum += edge.multiplicity * std::atan2(imaginary, real);
  }
  return sum / (2.0 * std::numbers::pi);
}

RTCScene make_scene(RTCDevice device, const TriangleMesh& mesh) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* positions = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                3 * sizeof(float), mesh.vertices.size()));
  for (const Vec3& vertex : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) *positions++ = static_cast<float>(vertex[axis]);
  }
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Triangle), mesh.triangles.size()));
  for (const Triangle& triangle : mesh.triangles) indices = std::copy(triangle.begin(), triangle.end(), indices);
  rtcSetGeometryIntersectFilterFunction(geometry, record_crossing);
  rtcCommitGeometry(geometry);

  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return scene;
}

}  // namespace

struct PaperTranscription::Implementation {
  explicit Implementation(const TriangleMesh& mesh)
      : edges(find_exterior_edges(mesh)), device(rtcNewDevice(nullptr)), scene(make_scene(device, mesh)) {}
  ~Implementation() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  // Replaces `crossings` by those of the ray from `origin` along +x.
  void cast(const Vec3& origin, std::vector<Crossing>& crossings) const {
    crossings.clear();
    RTCRayHit ray_hit{};
    ray_hit.ray.org_x = static_cast<float>(origin.x);
    ray_hit.ray.org_y = static_cast<float>(origin.y);
    ray_hit.ray.org_z = static_cast<float>(origin.z);
    ray_hit.ray.dir_x = 1.0F;
    ray_hit.ray.tfar = std::numeric_limits<float>::infinity();
    ray_hit.ray.mask = 0xFFFFFFFFU;
    ray_hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    CrossingContext context{};
    context.crossings = &crossings;
#if RTC_VERSION_MAJOR >= 4
    rtcInitRayQueryContext(&context.context);
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &context.context;
    rtcIntersect1(scene, &ray_hit, &arguments);
#else
    rtcInitIntersectContext(&context.context);
    rtcIntersect1(scene, &context.context, &ray_hit);
#endif
  }

  // The samples of row (j, k): crossings are passed from the far end, so that `count` is the number beyond a sample.
  void evaluate_row(const Lattice& lattice, std::int64_t j, std::int64_t k, std::span<double> row,
                    std::vector<Crossing>& crossings) const {
    const double reach = static_cast<double>(lattice.counts[0]) * lattice.spacing.x;
    Vec3 q{lattice.coordinate(0, lattice.index_min[0]) - reach, lattice.coordinate(1, j), lattice.coordinate(2, k)};
    cast(q, crossings);
    std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) { return a.x > b.x; });
    auto next = crossings.begin();
    int count = 0;
    for (std::size_t i = row.size(); i-- > 0;) {
      q.x = lattice.coordinate(0, lattice.index_min[0] + static_cast<std::int64_t>(i));
      for (; next != crossings.end() && double(next->x) > q.x; ++next) count += next->sign;
      row[i] = count - cone_winding_number(edges, q);
    }
  }

  std::vector<ExteriorEdge> edges;
  RTCDevice device;
  RTCScene scene;
};

PaperTranscription::PaperTranscription(const TriangleMesh& welded)
    : implementation_(std::make_unique<const Implementation>(welded)) {}
PaperTranscription::~PaperTranscription() = default;

std::size_t PaperTranscription::exterior_edges() const { return implementation_->edges.size(); }

void PaperTranscription::evaluate(const Lattice& lattice, std::span<double> values) const {
  const auto columns = static_cast<std::size_t>(lattice.counts[0]);
  const auto rows = static_cast<std::size_t>(lattice.counts[1] * lattice.counts[2]);
  parallel_for(rows, 1, [&](std::size_t begin, std::size_t end) {
    std::vector<Crossing> crossings;
    for (std::size_t row = begin; row < end; ++row) {
      const std::int64_t j = lattice.index_min[1] + static_cast<std::int64_t>(row) % lattice.counts[1];
      const std::int64_t k = lattice.index_min[2] + static_cast<std::int64_t>(row) / lattice.counts[1];
      implementation_->evaluate_row(lattice, j, k, values.subspan(row * columns, columns), crossings);
    }
  });
}

void PaperTranscription::evaluate(std::span<const Vec3> points, std::span<double> values) const {
  parallel_for(points.size(), 64, [&](std::size_t begin, std::size_t end) {
    std::vector<Crossing> crossings;
    for (std::size_t i = begin; i < end; ++i) {
      implementation_->cast(points[i], crossings);
      int count = 0;
      for (const Crossing& crossing : crossings) count += crossing.sign;
      values[i] = count - cone_winding_number(implementation_->edges, points[i]);
    }
  });
}

}  // namespace raycone::bench
