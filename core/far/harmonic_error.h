// What a harmonic fit makes of sources outside its cube.
#pragma once

namespace raycone {

// A dipole of unit strength at a point y, |y - centre| >= distance along some axis, has the field n . (q - y) /
// (4 pi |q - y|^3). On the cube, in half sides, no value of its fit (core/far/harmonic_fit.h) is off by more than this,
// whatever the direction n. A triangle is a sheet of dipoles: the fit of its solid angle, in turns, is off by its area,
// in squares of half sides, times this at most. Infinite below a distance of 1.5, and of NaN.
// tests/core/harmonic_error_table.py computes it; docs/method.md has the proof.
[[nodiscard]] double dipole_error(double distance);

}  // namespace raycone
