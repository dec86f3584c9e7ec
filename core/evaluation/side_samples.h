// The samples of a lattice whose sides of a rule are asked for.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/crossings/lattice_rows.h"
#include "core/crossings/lattice_sums.h"
#include "core/data/rule.h"
#include "core/data/sample_box.h"
#include "core/evaluation/lattice_tile.h"
#include "core/evaluation/scaled_mesh.h"
#include "core/evaluation/side_setter.h"
#include "core/evaluation/sums_round.h"

namespace raycone {

// Which crossings a sample's winding number is split into, and the rest, which is smooth where no cap comes in or, with
// kMesh, no cone.
enum class Crossings {
  kClosed,  // of the mesh less its caps, which is closed
  kMesh,
};

// Sides are set by certainty, where all that a winding number may be off by does not matter, or by its value. Different
// samples may be set at the same time. Arguments of the constructor must outlive this.
class SideSamples {
 public:
  using Index = std::array<std::size_t, 3>;  // along each axis

  // `crossings` are the finished runs of the mesh, `cap_crossings` those of mesh.caps(), both of `rows`, and both
  // without crossings where values depend on none. `sides`: one for each sample of `rows`, x fastest.
  SideSamples(const ScaledMesh& mesh, const LatticeRows& rows, const Rule& rule, const LatticeSums& crossings,
              const LatticeSums& cap_crossings, std::span<std::uint8_t> sides)
      : mesh_(mesh),
        rows_(rows),
        mesh_rule_(mesh, rule),
        crossings_(crossings),
        cap_crossings_(cap_crossings),
        sides_(sides) {}

  [[nodiscard]] const LatticeRows& rows() const { return rows_; }
  [[nodiscard]] const ScaledMesh& mesh() const { return mesh_; }

  [[nodiscard]] double crossings_at(const Index& sample, Crossings which) const {
    const std::size_t row = row_of(sample[1], sample[2]);
    const double n = crossings_.runs(row).at(sample[0]);
    return which == Crossings::kMesh ? n : n - cap_crossings_.runs(row).at(sample[0]);
  }

  // Adds the sample to a LatticeTile, which evaluates it.
  template <class Tile>
  void add(Tile& tile, std::size_t index, const Index& sample) const {
    const std::size_t row = row_of(sample[1], sample[2]);
    tile.add(index, rows_.query(sample), static_cast<std::int64_t>(crossings_.runs(row).at(sample[0])),
             static_cast<std::int64_t>(cap_crossings_.runs(row).at(sample[0])));
  }

  // Neighbours in space have codes that are near to each other (core/data/space_curve.h).
  [[nodiscard]] static std::uint64_t code_of(const Index& sample);

  // Sets the sides of all samples of the box if they are certain, the rest of each being `rest`, or off from it by at
  // most `needed`. Returns whether they are.
  bool decide(const SampleBox& box, Crossings which, double rest, double needed) const;

  // The same for each sample of a row from `first` on, of which rest[n] is that of sample n. Adds those that are not
  // certain to `undecided`, in runs.
  void decide_row(const Index& first, Crossings which, std::span<const double> rest, double needed,
                  std::vector<SampleBox>& undecided) const;

  // Sets the sides of all samples by their values: row by row, or neighbours in space together.
  void evaluate_rows(const SampleBox& box) const;
  void evaluate_each(std::span<const SampleBox> boxes) const;

 private:
  [[nodiscard]] std::size_t row_of(std::size_t j, std::size_t k) const { return k * rows_.ys.size() + j; }
  [[nodiscard]] auto place(std::size_t index) const { return sides_.begin() + static_cast<std::ptrdiff_t>(index); }

  // Whether numbers of turns that are off by at most `needed` are on w's side.
  [[nodiscard]] bool is_certain(double w, double needed) const {
    return distance_to_threshold(mesh_rule_.rule(), w) - kSumsRound * std::abs(w) > needed;
  }

  // As decide(), for samples of a row from that index on, which have the same crossings; rest[n] is that of sample n.
  bool decide_together(std::size_t index, double crossings, std::span<const double> rest, double needed) const;

  // visit(begin, end of the indices, crossings) for runs of samples whose crossings are the same, as long as it returns
  // true. Returns whether it always did.
  template <class Visit>
  bool for_each_run(const SampleBox& box, Crossings which, const Visit& visit) const;

  const ScaledMesh& mesh_;
  const LatticeRows& rows_;
  const MeshRule mesh_rule_;
  const LatticeSums& crossings_;
  const LatticeSums& cap_crossings_;
  std::span<std::uint8_t> sides_;
};

}  // namespace raycone
