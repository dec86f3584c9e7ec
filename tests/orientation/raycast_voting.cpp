// Baseline of docs/orientation.md: orientation by voting of rays. Kenshi Takayama, Alec Jacobson, Ladislav Kavan, Olga
// Sorkine-Hornung, "A Simple Method for Correcting Facet Orientations in Polygon Meshes Based on Ray Casting" (2014),
// written from the paper.
//
//   raycone_raycast_voting MESH FLIPS
//
// MESH is binary: numbers of vertices and faces (int64), vertices (3 doubles each), faces (3 int32 each). FLIPS gets
// one byte a face: 1 where it is to be reversed. The time without files, in seconds, goes to standard output. One
// thread.
//
// Faces are joined across edges that exactly two share and turned to agree, as bfs_orient does. Each patch then sends
// rays from points drawn by area, in directions drawn around the normal, to both sides. The side from which more rays
// escape is the front; where as many do, the side from which they fly farther to their first hit.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

constexpr int kFewestRays = 10;        // of a patch, to either side
constexpr double kRaysInAll = 20'000;  // shared out by area

using Vec = std::array<double, 3>;
using Face = std::array<std::int32_t, 3>;

Vec operator-(const Vec& a, const Vec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vec operator+(const Vec& a, const Vec& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Vec operator*(double s, const Vec& a) { return {s * a[0], s * a[1], s * a[2]}; }
double dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec cross(const Vec& a, const Vec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

struct Mesh {
  std::vector<Vec> vertices;
  std::vector<Face> faces;
};

Mesh read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<std::int64_t, 2> counts{};
  file.read(reinterpret_cast<char*>(counts.data()), sizeof counts);
  Mesh mesh;
  mesh.vertices.resize(static_cast<std::size_t>(counts[0]));
  mesh.faces.resize(static_cast<std::size_t>(counts[1]));
  file.read(reinterpret_cast<char*>(mesh.vertices.data()), static_cast<std::streamsize>(mesh.vertices.size() * 24));
  file.read(reinterpret_cast<char*>(mesh.faces.data()), static_cast<std::streamsize>(mesh.faces.size() * 12));
  if (!file) throw std::runtime_error(path + ": too short");
  return mesh;
}

// SplitMix64 (Guy Steele, Doug Lea, Christine Flood 2014).
class Random {
 public:
  double uniform() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_ = 1;
};

// --- First hit of a ray: a tree of boxes, halved at the median

class Tree {
 public:
  explicit Tree(const Mesh& mesh) : mesh_(mesh), order_(mesh.faces.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    for (const Face& face : mesh.faces) {
      middles_.push_back((1.0 / 3.0) * (mesh.vertices[static_cast<std::size_t>(face[0])] +
                                        mesh.vertices[static_cast<std::size_t>(face[1])] +
                                        mesh.vertices[static_cast<std::size_t>(face[2])]));
    }
    build(0, order_.size());
  }

  // Infinite where nothing is hit beyond `nearest`.
  [[nodiscard]] double first_hit(const Vec& from, const Vec& direction, double nearest) const {
    double best = std::numeric_limits<double>::infinity();
    visit(0, from, direction, nearest, best);
    return best;
  }

 private:
  struct Node {
    Vec lower, upper;
    std::size_t begin, end;
    std::size_t right = 0;  // its left child follows it; 0: a leaf
  };

  std::size_t build(std::size_t begin, std::size_t end) {
    Node node{{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}, begin, end};
    for (std::size_t n = begin; n < end; ++n) {
      for (const std::int32_t corner : mesh_.faces[order_[n]]) {
        for (std::size_t a = 0; a < 3; ++a) {
          node.lower[a] = std::min(node.lower[a], mesh_.vertices[static_cast<std::size_t>(corner)][a]);
          node.upper[a] = std::max(node.upper[a], mesh_.vertices[static_cast<std::size_t>(corner)][a]);
        }
      }
    }
    const std::size_t index = nodes_.size();
    nodes_.push_back(node);
    if (end - begin <= 4) return index;
    const Vec size = node.upper - node.lower;
    const auto axis = static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin());
    const std::size_t middle = (begin + end) / 2;
    const auto at = [&](std::size_t n) { return order_.begin() + static_cast<std::ptrdiff_t>(n); };
    std::nth_element(at(begin), at(middle), at(end),
                     [&](std::size_t a, std::size_t b) { return middles_[a][axis] < middles_[b][axis]; });
    build(begin, middle);
    const std::size_t right = build(middle, end);
    nodes_[index].right = right;
    return index;
  }

  static bool meets(const Node& node, const Vec& from, const Vec& direction, double most) {
    double least = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double one = (node.lower[a] - from[a]) / direction[a];
      const double other = (node.upper[a] - from[a]) / direction[a];
      least = std::max(least, std::min(one, other));
      most = std::min(most, std::max(one, other));
    }
    return least <= most * (1.0 + 1e-12);
  }

  // Tomas Moeller, Ben Trumbore (1997).
  [[nodiscard]] double hit(std::size_t face, const Vec& from, const Vec& direction) const {
    const auto corner = [&](std::size_t k) { return mesh_.vertices[static_cast<std::size_t>(mesh_.faces[face][k])]; };
    const Vec e1 = corner(1) - corner(0), e2 = corner(2) - corner(0);
    const Vec p = cross(direction, e2);
    const double determinant = dot(e1, p);
    if (determinant == 0.0) return std::numeric_limits<double>::infinity();
    const Vec s = from - corner(0);
    const double u = dot(s, p) / determinant;
    const Vec q = cross(s, e1);
    const double v = dot(direction, q) / determinant;
    if (u < 0.0 || v < 0.0 || u + v > 1.0) return std::numeric_limits<double>::infinity();
    return dot(e2, q) / determinant;
  }

  void visit(std::size_t index, const Vec& from, const Vec& direction, double nearest, double& best) const {
    const Node& node = nodes_[index];
    if (!meets(node, from, direction, best)) return;
    if (node.right != 0) {
      visit(index + 1, from, direction, nearest, best);
      visit(node.right, from, direction, nearest, best);
      return;
    }
    for (std::size_t n = node.begin; n < node.end; ++n) {
      const double distance = hit(order_[n], from, direction);
      if (distance > nearest) best = std::min(best, distance);
    }
  }

  const Mesh& mesh_;
  std::vector<std::size_t> order_;
  std::vector<Vec> middles_;
  std::vector<Node> nodes_;
};

// --- Patches

struct Patches {
  std::vector<std::vector<std::size_t>> faces;
  std::vector<std::uint8_t> flipped;  // to agree with the first face of its patch
};

struct EdgeUse {
  std::size_t face;
  bool forward;
};

std::map<std::pair<std::int32_t, std::int32_t>, std::vector<EdgeUse>> edge_uses(const Mesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<EdgeUse>> uses;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = mesh.faces[f][k], b = mesh.faces[f][(k + 1) % 3];
      uses[std::minmax(a, b)].push_back({f, a < b});
    }
  }
  return uses;
}

struct Neighbour {
  std::size_t face;
  bool agrees;
};

Patches patches_of(const Mesh& mesh) {
  std::vector<std::vector<Neighbour>> neighbours(mesh.faces.size());
  for (const auto& [edge, uses] : edge_uses(mesh)) {
    if (uses.size() != 2) continue;
    const bool agrees = uses[0].forward != uses[1].forward;
    neighbours[uses[0].face].push_back({uses[1].face, agrees});
    neighbours[uses[1].face].push_back({uses[0].face, agrees});
  }
  Patches patches;
  patches.flipped.assign(mesh.faces.size(), 0);
  std::vector<std::uint8_t> seen(mesh.faces.size());
  for (std::size_t first = 0; first < mesh.faces.size(); ++first) {
    if (seen[first] != 0) continue;
    std::vector<std::size_t> patch{first};
    seen[first] = 1;
    for (std::size_t n = 0; n < patch.size(); ++n) {
      for (const auto& [face, agrees] : neighbours[patch[n]]) {
        if (seen[face] != 0) continue;
        seen[face] = 1;
        patches.flipped[face] = patches.flipped[patch[n]] ^ (agrees ? 0U : 1U);
        patch.push_back(face);
      }
    }
    patches.faces.push_back(std::move(patch));
  }
  return patches;
}

// --- Voting

// Twice the area, along the normal.
Vec area_vector(const Mesh& mesh, std::size_t face) {
  const auto& [a, b, c] = mesh.faces[face];
  const Vec& origin = mesh.vertices[static_cast<std::size_t>(a)];
  return cross(mesh.vertices[static_cast<std::size_t>(b)] - origin,
               mesh.vertices[static_cast<std::size_t>(c)] - origin);
}

double length(const Vec& v) { return std::sqrt(dot(v, v)); }

Vec point_on(const Mesh& mesh, std::size_t face, Random& random) {
  double u = random.uniform(), v = random.uniform();
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  const auto& [a, b, c] = mesh.faces[face];
  const Vec& origin = mesh.vertices[static_cast<std::size_t>(a)];
  return origin + u * (mesh.vertices[static_cast<std::size_t>(b)] - origin) +
         v * (mesh.vertices[static_cast<std::size_t>(c)] - origin);
}

// Uniform over the half of the sphere around `normal`.
Vec direction_around(const Vec& normal, Random& random) {
  const double z = 2.0 * random.uniform() - 1.0;
  const double angle = 2.0 * std::numbers::pi * random.uniform();
  const double r = std::sqrt(1.0 - z * z);
  const Vec direction{r * std::cos(angle), r * std::sin(angle), z};
  return dot(direction, normal) < 0.0 ? -1.0 * direction : direction;
}

// Of one side.
struct Votes {
  int escaped = 0;
  double distance = 0.0;

  void add(double hit) {
    if (std::isinf(hit)) {
      ++escaped;
    } else {
      distance += hit;
    }
  }
};

class Voting {
 public:
  explicit Voting(const Mesh& mesh) : mesh_(mesh), patches_(patches_of(mesh)), tree_(mesh) {
    for (std::size_t face = 0; face < mesh.faces.size(); ++face) area_ += length(area_vector(mesh, face));
    Vec lower = mesh.vertices.front(), upper = lower;
    for (const Vec& p : mesh.vertices) {
      for (std::size_t a = 0; a < 3; ++a) {
        lower[a] = std::min(lower[a], p[a]);
        upper[a] = std::max(upper[a], p[a]);
      }
    }
    tiny_ = 1e-9 * length(upper - lower);
  }

  std::vector<std::uint8_t> flips() {
    std::vector<std::uint8_t> flips = patches_.flipped;
    for (const std::vector<std::size_t>& patch : patches_.faces) {
      if (!faces_inward(patch)) continue;
      for (const std::size_t face : patch) flips[face] ^= 1U;
    }
    return flips;
  }

 private:
  bool faces_inward(const std::vector<std::size_t>& patch) {
    std::vector<double> areas;  // up to each face
    double part = 0.0;
    for (const std::size_t face : patch) {
      const double area = length(area_vector(mesh_, face));
      areas.push_back(area + (areas.empty() ? 0.0 : areas.back()));
      part += area / area_;
    }
    if (areas.back() == 0.0) return false;
    Votes front, back;
    const int rays = std::max(kFewestRays, static_cast<int>(kRaysInAll * part));
    for (int ray = 0; ray < rays; ++ray) {
      const auto drawn = std::ranges::upper_bound(areas, random_.uniform() * areas.back()) - areas.begin();
      const std::size_t face = patch[std::min(static_cast<std::size_t>(drawn), patch.size() - 1)];
      const Vec normal = (patches_.flipped[face] != 0 ? -1.0 : 1.0) * area_vector(mesh_, face);
      const Vec from = point_on(mesh_, face, random_);
      front.add(tree_.first_hit(from, direction_around(normal, random_), tiny_));
      back.add(tree_.first_hit(from, direction_around(-1.0 * normal, random_), tiny_));
    }
    return std::pair(front.escaped, front.distance) < std::pair(back.escaped, back.distance);
  }

  const Mesh& mesh_;
  Patches patches_;
  Tree tree_;
  double area_ = 0.0;  // twice that of all faces
  double tiny_;        // nearer hits are the face itself, or its double
  Random random_;
};

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 3) throw std::runtime_error("usage: raycone_raycast_voting MESH FLIPS");
    const Mesh mesh = read(argv[1]);
    const auto begin = std::chrono::steady_clock::now();
    const std::vector<std::uint8_t> flips = Voting(mesh).flips();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    std::ofstream(argv[2], std::ios::binary)
        .write(reinterpret_cast<const char*>(flips.data()), static_cast<std::streamsize>(flips.size()));
    std::printf("%.6f\n", seconds.count());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "raycone_raycast_voting: %s\n", error.what());
    return 1;
  }
  return 0;
}
