// The readers behind open_points(), one per format.
#pragma once

#include <memory>
#include <string>

#include "io/files/input_buffer.h"
#include "io/points/read_points.h"

namespace raycone {

// Each takes over an input of which nothing has been consumed. Throw InputError.
[[nodiscard]] std::unique_ptr<PointReader> read_text_points(std::unique_ptr<InputBuffer> input,
                                                            const ReadPointsOptions& options);
[[nodiscard]] std::unique_ptr<PointReader> read_raw_points(std::unique_ptr<InputBuffer> input, RawPrecision precision);
[[nodiscard]] std::unique_ptr<PointReader> read_npy_points(std::unique_ptr<InputBuffer> input);
// The array `points` of NumPy's archive at `path`.
[[nodiscard]] std::unique_ptr<PointReader> read_npz_points(const std::string& path);
[[nodiscard]] std::unique_ptr<PointReader> read_ply_points(std::unique_ptr<InputBuffer> input);

}  // namespace raycone
