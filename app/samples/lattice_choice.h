// From a box and the lattice options to the lattice. The rules are those of docs/formats.md, "Lattices".
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "app/options/lattice_request.h"
#include "core/data/box.h"
#include "core/data/lattice.h"
#include "core/data/warning.h"
#include "io/files/file_error.h"

namespace raycone {

// A side that exceeds a multiple of the spacing by no more than this fraction of the spacing, which is rounding, gets
// no sample behind its end. The same for pixels of slices.
inline constexpr double kRoundingSlack = 1e-9;

// A description of each flat side for which more than one sample was asked is appended to `warnings`. Throws
// UsageError where negative padding leaves nothing, LimitError where double or the indices cannot hold the lattice.
[[nodiscard]] Lattice choose_lattice(const Box& mesh_box, const LatticeRequest& request,
                                     std::vector<Warning>& warnings);

// The lattice with so many samples more at either end of each axis. Throws as choose_lattice().
using Layers = std::array<std::int64_t, 3>;
[[nodiscard]] Lattice with_layers(Lattice lattice, const Layers& layers);

// How many layers of samples the lattice of a surface has around what is asked for: one, or none where that has some
// itself.
[[nodiscard]] Layers layers_around(const std::variant<LatticeRequest, GridReference>& asked);

// The box widened by `padding`. Throws UsageError where a negative width leaves nothing.
[[nodiscard]] Box widened(Box box, const WorldPadding& padding);

// The number of samples. Throws LimitError, with the number, where it exceeds 64 bits, or kMaxBlockSide along an axis.
[[nodiscard]] std::uint64_t sample_count(const Lattice& lattice);

// Returns choose(). A LimitError that it throws gets the name of the file concerned.
template <class Choose>
[[nodiscard]] auto choose_for(const std::string& file, const Choose& choose) {
  try {
    return choose();
  } catch (const LimitError& error) {
    throw LimitError(file + ": " + error.what());
  }
}

}  // namespace raycone
