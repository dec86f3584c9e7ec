"""The mutants: what to replace, and which rule of docs/method.md that breaks.

Each old text must occur exactly once in its file. Change a mutant together with the code that it breaks; remove it only
if the rule is gone. A mutant that changes no result that anybody can observe proves nothing and does not belong here.
"""

from typing import NamedTuple


class Mutant(NamedTuple):
    name: str
    breaks: str
    edits: list  # of (file, old text, new text)


MUTANTS = [
    # --- One perturbation ---
    Mutant("tie_is_no_side", "edge side: ties are decided by the perturbation, not dropped", [
        ("core/exact/predicates.h", "if (a.z != b.z) return {a.z > b.z ? 1 : -1, true};\n"
         "  if (a.y != b.y) return {b.y > a.y ? 1 : -1, true};\n", "")]),
    Mutant("tie_is_positive", "edge side: a tie depends on the direction of the edge", [
        ("core/exact/predicates.h", "return sign != 0 ? EdgeSide{sign, false} : broken_tie(a, b);",
         "return sign != 0 ? EdgeSide{sign, false} : EdgeSide{broken_tie(a, b).sign != 0, true};")]),
    Mutant("tie_by_y_before_z", "edge side: e2 >> e3, so a_z - b_z decides before b_y - a_y", [
        ("core/exact/predicates.h", "if (a.z != b.z) return {a.z > b.z ? 1 : -1, true};\n"
         "  if (a.y != b.y) return {b.y > a.y ? 1 : -1, true};",
         "if (a.y != b.y) return {b.y > a.y ? 1 : -1, true};\n"
         "  if (a.z != b.z) return {a.z > b.z ? 1 : -1, true};")]),
    Mutant("plane_is_crossed", "crossing: orient3d = 0 is none", [
        ("core/crossings/crossings.cpp", "if (side(middle) == -result.sigma) {", "if (side(middle) != result.sigma) {")]),
    Mutant("on_surface_not_at_ties", "on the surface: also where the line meets an edge or vertex", [
        ("core/crossings/crossings.cpp", "  } else {\n    find_samples_on({a, b, c}, {ab, bc, ca}, row, result);\n", "")]),
    Mutant("on_surface_without_rounding", "on the surface: places on edges are rounded, samples are not", [
        ("core/crossings/crossings.cpp", "constexpr double kRounding = 0x1p-49,", "constexpr double kRounding = 0.0,")]),
    Mutant("on_surface_not_of_level_edges", "on the surface: edges along the line meet it in all of their points", [
        ("core/crossings/crossings.cpp", "if (step[axis] == 0.0) return row.y == p.y && row.z == p.z ? whole : kEmptyInterval;",
         "if (step[axis] == 0.0) return kEmptyInterval;")]),
    Mutant("on_surface_cancels", "on the surface: duplicated faces that cancel are surface, too", [
        ("core/crossings/lattice_sums.cpp", "std::atomic_ref(flags[first + i]).store(1, std::memory_order_relaxed);",
         "flags[first + i] ^= 1;")]),
    Mutant("degenerate_without_box", "ties count for triangles whose closed box meets the closed ray", [
        ("core/crossings/crossings.cpp", "  if (!box_meets_line(a, b, c, row)) return {};  // a tie with the line of an edge, beyond the triangle\n", "")]),

    # --- Numbers of 16 bits ---
    Mutant("half_ties_upwards", "a double becomes the nearest half, of two the even one", [
        ("io/files/half.h", "(clamped + large) - large", "(clamped + large * 0x1p-60 + large) - large")]),
    Mutant("half_across_the_threshold", "a stored number is on the threshold's side", [
        ("io/fields/array_elements.cpp", "elements[begin + n] = bits_of_half(stored[n]);",
         "elements[begin + n] = bits_of_half(nearest_half(piece[n]));")]),

    # --- Exact signs, shared ---
    Mutant("sign_not_shared", "the cone takes the sign of D from edge_side, as crossings do", [
        ("core/boundary/edge_factor.cpp", "std::copysign(f->im, side.sign)",
         "side.tie ? std::copysign(f->im, side.sign) : f->im")]),
    Mutant("kernel_trusts_any_sign", "the SIMD kernel multiplies only factors whose sign is sure", [
        ("core/boundary/edge_lanes-inl.h", "hn::IfThenElse(sure, im, hn::NaN(d))", "((void)sure, im)")]),
    Mutant("side_filter_too_small", "floating point decides only where its error bound vouches for it", [
        ("core/exact/predicates.h", "kSideFilter = 4.0 * 0x1p-53", "kSideFilter = 0.25 * 0x1p-53")]),
    Mutant("side_filter_without_underflow", "products that underflow vouch for nothing", [
        ("core/exact/predicates.h", "kSideUnderflow = 0x1p-1000", "kSideUnderflow = 0.0")]),
    Mutant("float_crossings", "crossings are decided on double coordinates", [
        ("core/crossings/crossings.cpp",
         "triangle_crossing(const Vec3& a, const Vec3& b, const Vec3& c, const Row& row,\n"
         "                                   const TrianglePlane* plane) {\n",
         "triangle_crossing(const Vec3& u, const Vec3& v, const Vec3& w, const Row& row,\n"
         "                                   const TrianglePlane* plane) {\n"
         "  const auto rounded = [](const Vec3& p) { return Vec3{float(p.x), float(p.y), float(p.z)}; };\n"
         "  const Vec3 a = rounded(u), b = rounded(v), c = rounded(w);\n")]),
    Mutant("plane_error_too_small", "the place of a crossing along a row is only trusted beyond its error", [
        ("core/crossings/crossings.cpp", "error = 1.01 * u *", "error = 0.01 * u *")]),
    Mutant("grid_error_too_small", "single precision decides for points only beyond its error", [
        ("core/crossings/projected_grid.cpp", "6.01 * v *", "0.06 * v *"), ("core/crossings/projected_grid.cpp", "3.01 * v *", "0.03 * v *")]),
    Mutant("grid_without_lines", "a triangle is listed where the lines of its edges tie, too", [
        ("core/crossings/projected_grid_builder.cpp", "      if (intersection(slab, edge.z).empty()) continue;\n",
         "      if (intersection(slab, edge.z).empty()) { parts[i] = kEmptyInterval; continue; }\n")]),
    Mutant("grid_cuts_too_early", "rays from behind a triangle alone miss it", [
        ("core/crossings/projected_grid_builder.cpp", "rounded_up(largest(a.x, b.x, c.x))",
         "static_cast<float>(largest(a.x, b.x, c.x) - 0x1p-30)")]),
    Mutant("grid_misses_rays", "rays that meet nothing are told by all cells that they may be in", [
        ("core/crossings/projected_grid.cpp", "at(((square + 1) << coarser_) + kMargin)", "at(square << coarser_)")]),
    Mutant("passes_miss_rays", "a pass finds rays in the last bin that a triangle reaches, too", [
        ("core/crossings/binned_rays.h", "begins_[row * y_.bins + last + 1];", "begins_[row * y_.bins + last];")]),
    Mutant("pass_leaves_out_the_far_box", "a ray that begins behind the mesh is left out, no other", [
        ("core/evaluation/point_crossings.cpp", "return !ray.meets(mesh.box());", "return !ray.meets(mesh.box()) || ray.origin.x < mesh.box().lower.x;")]),
    Mutant("pass_gives_up_in_silence", "a pass that would take longer than a grid is not used", [
        ("core/evaluation/point_crossings.cpp", "return patience.is_lost() ? std::nullopt : std::optional(std::move(crossings));", "return crossings;")]),
    Mutant("sections_without_lines", "a long triangle concerns the rows on the lines of its edges, too", [
        ("core/crossings/triangle_sections.h", "  std::sort(parts.begin(),", "  parts[0] = parts[1] = parts[2] = nothing;\n  std::sort(parts.begin(),")]),
    Mutant("sections_without_error", "where a line is, is known up to rounding", [
        ("core/crossings/triangle_sections.h", "kError = 8 * 0x1p-53, kSlopeUnderflow", "kError = 0, kSlopeUnderflow")]),
    Mutant("plane_underflow_ignored", "what underflows in a normal is multiplied by the extent, and divided", [
        ("core/crossings/crossings.cpp", " + kUnderflow / nx * extent", "")]),
    Mutant("slope_underflow_ignored", "what underflows in a slope is multiplied by the reach", [
        ("core/crossings/triangle_sections.h", "kSlopeUnderflow * std::abs(reach) + ", "")]),
    Mutant("sections_of_widths_beyond_doubles", "a slope over a width that overflows is not 0", [
        ("core/crossings/triangle_sections.h", "std::isfinite(width) ? height / width : std::numeric_limits<double>::quiet_NaN()",
         "height / width")]),
    Mutant("gradient_takes_all", "a query that scaling makes subnormal is summed unscaled", [
        ("core/evaluation/gradient.cpp", "} else if (largest_coordinate(q) < kFar && scale_.keeps(p.x) && scale_.keeps(p.y) && scale_.keeps(p.z)) {",
         "} else if (true) {")]),
    Mutant("source_areas_vanish", "squares of areas underflow", [
        ("core/far/triangle_extent.cpp", "safe_norm(t.normal)", "norm(t.normal)")]),
    Mutant("cap_areas_vanish", "squares of areas underflow", [
        ("core/boundary/change_bound.cpp", "safe_norm(normal)", "norm(normal)")]),
    Mutant("surfaces_unscaled", "products of areas overflow far from 1", [
        ("core/surface/surface_in_scale.cpp", "> kFar", "> 64 * kFar")]),
    Mutant("boxes_without_slack", "Embree drops boxes whose face contains the ray, unless enlarged", [
        ("core/crossings/ray_caster.cpp", "kSlack = 4.0F * 0x1p-23F", "kSlack = 0.0F")]),
    Mutant("no_floating_point_guard", "predicates need gradual underflow, whatever the caller has set", [
        ("core/machine/threads.cpp", "    const DefaultFloatingPoint guard;\n", "")]),

    # --- Slabs and sums ---
    Mutant("slabs_miss_triangles", "a slab looks at all triangles that meet it", [
        ("core/crossings/slab_order.cpp", "hull(groups_[n], extent_of(mesh, mesh.triangles[triangle], axis))",
         "{std::min(groups_[n].lower, extent_of(mesh, mesh.triangles[triangle], axis).lower), groups_[n].upper}")]),
    Mutant("kept_crossings_lost", "crossings that were kept count where many are added up", [
        ("core/crossings/lattice_sums.cpp", "  for (const std::vector<RowCrossing>& part : parts_) add_to_samples(part);\n", "")]),
    Mutant("rest_of_rows_lost", "what a row leaves shares a tile with other rows", [
        ("core/evaluation/rows.cpp", "  tiles.finish();\n", "")]),
    Mutant("level_edges_dropped", "only an edge along the rays has no argument anywhere", [
        ("core/boundary/boundary.cpp", "return a.y == b.y && a.z == b.z;", "return a.z == b.z;")]),

    # --- The cone's factors ---
    Mutant("determinant_from_farther_end", "D is computed from the edge's nearer end", [
        ("core/exact/predicates.h", "<= std::abs(b.y - q.y) + std::abs(b.z - q.z);",
         "> std::abs(b.y - q.y) + std::abs(b.z - q.z);"),
        ("core/boundary/edge_lanes-inl.h", "hn::Le(a.square, b.square)", "hn::Gt(a.square, b.square)")]),
    Mutant("s_cancels", "s = |P|^2 / (|p| + p_x) ahead, which does not cancel", [
        ("core/boundary/cone_kernel.cpp", "store(hn::IfNegativeThenElse(px, sum, square), s, n);",
         "store(hn::IfNegativeThenElse(px, sum, hn::Sub(sum, hn::Add(px, px))), s, n);"),
        ("core/boundary/cone_kernel.cpp", "store(hn::IfNegativeThenElse(px, hn::Set(d, 1.0), sum), t, n);",
         "store(hn::Set(d, 1.0), t, n);")]),
    Mutant("no_factor_through_vertex", "a ray through an end of an edge: (s, P) = (0, -1) there", [
        ("core/boundary/edge_factor.cpp", "a.x > q.x ? std::optional(factor(-by, bz)) : std::nullopt", "std::nullopt"),
        ("core/boundary/edge_factor.cpp", "b.x > q.x ? std::optional(factor(-ay, az)) : std::nullopt", "std::nullopt")]),
    Mutant("vertex_behind_counts", "an end at or behind the query gives no argument", [
        ("core/boundary/edge_factor.cpp", "return a.x > q.x ?", "return true ?"),
        ("core/boundary/edge_factor.cpp", "return b.x > q.x ?", "return true ?")]),
    Mutant("meeting_side_ignored", "half a turn only if the edge meets the line ahead of the query", [
        ("core/boundary/edge_factor.cpp", "meeting_side(a, b, q) > 0 ?", "true ?")]),
    Mutant("edge_at_query_counts", "no argument if the edge meets the line at the query", [
        ("core/boundary/edge_factor.cpp", "meeting_side(a, b, q) > 0 ?", "meeting_side(a, b, q) >= 0 ?")]),
    Mutant("no_near_edge_factor", "near an edge z cancels, in any precision", [
        ("core/boundary/near_edge.h", "constexpr double kNearEdge = 0x1p-8;", "constexpr double kNearEdge = 0.0;")]),
    Mutant("near_edge_normal_in_double", "N must be known to full relative precision", [
        ("core/exact/exact_determinant.h", "  return sum.rounded();", "  const auto in_double = [](const Difference& x) { return x.plus + x.minus; };\n"
         "  return in_double(a) * in_double(d) - in_double(b) * in_double(c);")]),
    Mutant("near_edge_form_always_plain", "the better conditioned of z and z' is taken", [
        ("core/boundary/near_edge.cpp", "plain.condition() <= normal.condition() ||", "true ||")]),
    Mutant("near_edge_form_always_normal", "the better conditioned of z and z' is taken", [
        ("core/boundary/near_edge.cpp", "plain.condition() <= normal.condition() ||", "")]),
    Mutant("underflow_is_ordinary", "|P|^2 that has underflowed or overflowed serves for nothing", [
        ("core/boundary/edge_lanes-inl.h", "return hn::IfThenElse(ordinary, square, hn::NaN(d));",
         "return (void)ordinary, square;"),
        ("core/boundary/edge_factor.cpp", "return square > kSmallest && square < kLargest && std::abs(x) < kLargestX;",
         "return true;")]),

    Mutant("all_level_edges_are_beside", "an edge that meets the ray's line has a factor", [
        ("core/boundary/level_edges-inl.h", "hn::And(is_zero(a_z, b_z), same_side(a_y, b_y))", "is_zero(a_z, b_z)")]),

    # --- The sum over triangles ---
    Mutant("triangles_of_any_side", "the kernel multiplies only factors of triangles whose side is sure", [
        ("core/boundary/triangle_lanes-inl.h", "hn::Gt(hn::Abs(im), doubt)", "hn::Ge(hn::Abs(im), hn::Sub(doubt, doubt))")]),
    Mutant("no_care_next_to_triangles", "next to a triangle z_T cancels", [
        ("core/boundary/triangle_lanes-inl.h", "kNearTriangle = 0x1p-6 /", "kNearTriangle = 0.0 /"),
        ("core/boundary/triangle_lanes-inl.h", "kNearCorner = 0x1p-8 /", "kNearCorner = 0.0 /")]),
    Mutant("triangles_do_not_cross", "a careful factor holds the triangle's crossing", [
        ("core/boundary/triangle_lanes-inl.h", "triangle_crossing(t.a, t.b, t.c, q).sigma", "0")]),
    Mutant("triangles_as_they_come", "the order of faces changes no bit", [
        ("core/boundary/solid_angles.cpp",
         "return s.first != t.first ? s.first < t.first : order(all[s.number], all[t.number]) < 0;",
         "return s.number < t.number;")]),

    # --- The product ---
    Mutant("turns_by_comparison", "turns are told by sign bits: -0 is below the axis", [
        ("core/boundary/product_lanes-inl.h", "std::signbit(before) != std::signbit(product_im)",
         "(before < 0) != (product_im < 0)"),
        ("core/boundary/product_lanes-inl.h", "std::signbit(im) ? -1.0 : 1.0;", "im < 0 ? -1.0 : 1.0;")]),
    Mutant("no_turns", "the running product's turns are counted", [
        ("core/boundary/product_lanes-inl.h", "hn::Add(z.passages, hn::IfNegativeThenElse(hn::Xor(z.im, im), direction, hn::Zero(d)))",
         "z.passages")]),
    Mutant("no_turns_of_careful_factors", "the running product's turns are counted", [
        ("core/boundary/product_lanes-inl.h", "z.passages[i] += std::signbit(im) ? -1.0 : 1.0;", "{}")]),
    Mutant("product_never_scaled", "the power of two is taken out of the product", [
        ("core/boundary/cone_kernel.cpp", "store(scaled(z), products, stage.i);", "store(z, products, i);")]),
    Mutant("factors_of_any_size", "a factor too large or small for eight of them is scaled first", [
        ("core/boundary/product_lanes-inl.h", "kSmallestFactor = 0x1p-120;", "kSmallestFactor = 0.0;"),
        ("core/boundary/product_lanes-inl.h", "kLargestFactor = 0x1p120;", "kLargestFactor = 0x1p1023;")]),
    Mutant("blocks_of_any_size", "a block may underflow or overflow, and is then multiplied factor by factor", [
        ("core/boundary/edge_lanes-inl.h", "kSmallestSquare = 0x1p-50;", "kSmallestSquare = 0x1p-800;"),
        ("core/boundary/product_lanes-inl.h", "hn::Set(d, kLargestProduct)", "hn::Inf(d)")]),
    Mutant("multiplicity_is_one", "edges with |m| > 1 count |m| times", [
        ("core/boundary/boundary.cpp", "multiplicity = std::abs(e.multiplicity);", "multiplicity = 1;")]),

    Mutant("crowds_in_double", "arguments that are multiplied by hundreds have 64 bits", [
        ("core/boundary/cone.cpp", "kLargestInDouble = 32;", "kLargestInDouble = 2'000'000'000;")]),
    *[Mutant(f"{kernel}_off_by_{by}", "a value is right, and --verify finds out where it is not", [
        (f"core/boundary/{kernel}_kernel.cpp", "  set_arguments(products, samples.count);\n",
         "  set_arguments(products, samples.count);\n"
         f"  for (std::size_t i = 0; i < samples.count; ++i) products.argument[i] += {by};\n")])
      for kernel in ("cone", "solid_angle") for by in ("1e-9", "1e-6", "0.1")],

    # --- Rules ---
    Mutant("halves_by_rounding", "in the plane of an opening w is 1/2 exactly", [
        ("core/evaluation/scaled_mesh.cpp",
         "if (count > 0) boundary_.settle(samples, {doubtful.data(), count}, values);", "")]),
    Mutant("doubt_too_small", "a value within its bound of a half-integer is looked at again", [
        ("core/boundary/winding_number_engine.cpp", "kDoubtPerEdge = 0x1p-41;", "kDoubtPerEdge = 0x1p-62;")]),
    Mutant("rim_is_plane", "on an exterior edge w is no multiple of 1/2", [
        ("core/boundary/boundary.cpp", "if (step.joined && on_segment(group.steps[i - 1].to, step.to, q)) return false;", "")]),
    Mutant("all_edges_in_one_plane", "one exterior edge out of the plane of the others counts", [
        ("core/boundary/boundary.cpp", "} else if (plane_side(*a, *b, *c, v) != 0) {\n        return;\n      }", "}")]),
    Mutant("settled_in_106_bits", "113 bits tell what 106 cannot", [
        ("core/boundary/boundary.cpp", "if (!side) side = side_of(", "if (!side && false) side = side_of(")]),
    Mutant("settled_in_double", "double precision cannot tell a half-integer from what is next to it", [
        ("core/boundary/boundary.cpp", "w[i] = on_side(side.value_or(0), critical, w[i]);", "")]),
    Mutant("settled_to_the_wrong_side", "a value is on the side of a half-integer on which w is", [
        ("core/boundary/boundary.cpp", "return side > 0 ? std::max", "return side < 0 ? std::max")]),

    # --- Magnitudes ---
    Mutant("mesh_not_scaled", "w(2^k M, 2^k q) is w(M, q) to the bit", [
        ("core/exact/scale.cpp", "const PowerOfTwo scale(-exponent);", "const PowerOfTwo scale(0);"),
        ("core/exact/scale.cpp", "const PowerOfTwo inverse(exponent);", "const PowerOfTwo inverse(0);")]),
    Mutant("mesh_scaled_at_a_loss", "no scaling where it would cost a vertex bits", [
        ("core/exact/scale.cpp", "return PowerOfTwo(0);\n    }\n  }\n  return scale;", "return scale;\n    }\n  }\n  return scale;")]),
    Mutant("query_scaled_at_a_loss", "no scaling where it would cost a query bits", [
        ("core/exact/scale.h", "return std::abs(value) >= least_ || value == 0.0;", "return least_ >= 0.0 || value == 0.0;")]),
    Mutant("query_not_clamped", "queries beyond 2^1000 mesh sizes are taken to be there", [
        ("core/evaluation/scaled_mesh.h", "std::clamp(scale_(x), -kFarthest, kFarthest)", "scale_(x)")]),

    Mutant("long_triangles_trusted", "a factor of a triangle with one minute and two huge corners is not trusted", [
        ("core/boundary/solid_angles.cpp", "kLongest = 0x1p60;", "kLongest = HUGE_VAL;")]),
    Mutant("scale_by_block", "whether a sample is evaluated in scale depends on no other sample", [
        ("core/evaluation/rows.cpp", "if (parts.size() == 1) return evaluate_part(", "if (!parts.empty()) return evaluate_part(")]),

    # --- Polygons ---
    Mutant("concave_fanned", "concave polygons are cut", [
        ("core/mesh/polygons.cpp", "if (polygon.size() <= 3) return true;", "if (polygon.size() <= 6) return true;")]),
    Mutant("left_turns_are_convex", "what turns left everywhere may still wind twice", [
        ("core/mesh/polygons.cpp", "never_turns_right(polygon) && fan_opens_once(polygon)", "never_turns_right(polygon)")]),
    Mutant("fan_without_turns", "convex polygons never turn right", [
        ("core/mesh/polygons.cpp", "never_turns_right(polygon) && fan_opens_once(polygon)", "fan_opens_once(polygon)")]),
    Mutant("fan_opens_again", "flat triangles are the first or the last of a fan", [
        ("core/mesh/polygons.cpp", "(turn > 0 && place == kBehind) || ", "")]),
    Mutant("turns_in_floating_point", "floating point decides only turns that its error bound vouches for", [
        ("core/exact/projection.h", "kTurnTrust = 0x1p-49", "kTurnTrust = 0x1p-60")]),
    Mutant("turns_that_underflow", "products that underflow vouch for nothing", [
        ("core/exact/projection.h", "kTurnUnderflow = 0x1p-960", "kTurnUnderflow = 0.0"),
        ("core/exact/projection.h", "return exact_turn(direction, a, b, c);", "return 0;")]),
    Mutant("collinear_by_overflow", "products that overflow are not equal", [
        ("core/exact/projection.cpp", " && std::isfinite(left)", "")]),
    Mutant("seen_along_z", "polygons are seen along their area vector", [
        ("core/mesh/polygons.cpp", "direction_ = area_direction(corners_);", "direction_ = Vec3{0, 0, area_direction(corners_).z};")]),
    Mutant("winding_not_looked_at", "polygons that wind twice, or backwards, are bad", [
        ("core/mesh/polygon_cut.cpp", "if (winding != 0 && winding != 1) return false;", "")]),
    Mutant("ends_not_looked_for", "an edge that crossed another is not where it ends", [
        ("core/mesh/polygon_cut.cpp", "if (ends_[p] != 0 || (edge", "if ((edge")]),
    Mutant("order_not_looked_at", "a corner is below the next edge, or edges have crossed", [
        ("core/mesh/polygon_cut.cpp",
         "if (ends_[p] != 0 || (edge != edges_.end() && side(*edge, p) > 0)) return false;",
         "if (ends_[p] != 0) return false;")]),
    Mutant("bridge_counts_once", "a bridge's two ways cancel", [
        ("core/mesh/polygon_cut.cpp", "      count += run.count;", "      count = run.count;")]),
    Mutant("edge_stays_split", "a corner on another edge leaves the boundary as it was", [
        ("core/mesh/polygon_cut.cpp", "      add_flat(edge->first, edge->left, p, -edge->count);\n", "")]),
    Mutant("overlap_stays_split", "an edge that overlaps others leaves the boundary as it was", [
        ("core/mesh/polygon_cut.cpp", "      add_flat(first, p, run.end, whole);\n", "")]),
    Mutant("cut_turned_over", "no triangle is turned over", [
        ("core/mesh/polygon_cut.cpp",
         "if (turn(links_[low].point, p, links_[high].point) <= 0) return false;",
         "if (turn(links_[low].point, p, links_[high].point) == 0) return false;")]),

    # --- Determinism, identity, error bound ---
    Mutant("edges_by_index", "exterior edges are ordered by coordinates", [
        ("core/mesh/edge_chains.cpp", "ranks_[vertices_.place(placed[rank].vertex)] = rank;",
         "ranks_[rank] = rank;")]),
    Mutant("few_points_of_gauss", "moments are exact up to the order of their expansion", [
        ("core/far/multipole.cpp", "const std::size_t exact = static_cast<std::size_t>(order - 1) / 2 + 1;",
         "const std::size_t exact = static_cast<std::size_t>(order) / 2;")]),
    Mutant("nothing_left_out_of_moments", "what few points leave out is within the bound", [
        ("core/far/multipole.cpp", "if (n <= derivative) return 0;", "if (n >= 0) return 0;")]),
    Mutant("negative_zero_kept", "vertices are identified by position, and -0 is 0", [
        ("core/mesh/weld.cpp", "return {p.x + 0.0, p.y + 0.0, p.z + 0.0};", "return p;")]),
    Mutant("equal_hashes_are_equal", "vertices are merged by their coordinates, never by a hash alone", [
        ("core/mesh/equal_vertices.cpp", "if (all_equal(vertices, first)) return first;", "return first;")]),
    Mutant("near_within_a_run", "a vertex joins a representative within the distance, also across runs of coordinates", [
        ("core/mesh/near_vertices.cpp", "runs_[run + 1].first - x <= distance_;", "runs_[run + 1].first - x < 0;")]),
    Mutant("near_any_representative", "of several representatives within the distance the first is joined", [
        ("core/mesh/near_vertices.cpp", "first = std::min(first, r);", "first = r;")]),
    Mutant("loops_take_part_in_others", "who waits for a loop within a loop takes no part in the outer one", [
        ("core/machine/threads.cpp", "isolated([&] { run_loop(count, grain, body); });", "run_loop(count, grain, body);")]),
    Mutant("error_bound_too_small", "the error bound is rigorous", [
        ("core/boundary/boundary.cpp", "static_cast<double>(bound), std", "static_cast<double>(bound) * 0.001, std")]),
    Mutant("error_bound_of_the_sum_only", "the error bound holds for the value, not only for the wider sum", [
        ("core/boundary/boundary.cpp", "bound = absolute(w[i] - w2) + cones[i].bound", "bound = cones[i].bound")]),

    # --- Points that are drawn ---
    Mutant("area_by_rounding", "areas are right for triangles of every shape and size", [
        ("core/sampling/point_sampler.cpp", "return in_range && product > kThinnest * lengths ? product : exact_doubled_area(a, b, c);",
         "return ((void)in_range, (void)kThinnest, (void)exact_doubled_area, product);")]),
    Mutant("area_filter_too_small", "doubles decide an area only where its error bound vouches for it", [
        ("core/sampling/point_sampler.cpp", "kThinnest = 0x1p-20", "kThinnest = 0x1p-60")]),
    Mutant("area_in_world_units", "areas may be below the range of doubles", [
        ("core/sampling/point_sampler.cpp", "unit * s", "((void)unit, s)")]),
    Mutant("triangle_without_root", "points are uniform within a triangle", [
        ("core/sampling/point_sampler.cpp", "from_a = std::sqrt(random.uniform())", "from_a = random.uniform()")]),
    Mutant("points_out_of_their_box", "points of faces across an axis lie in them exactly", [
        ("core/sampling/point_sampler.cpp", "p[axis] = std::clamp(p[axis], least, most);", "(void)std::clamp(p[axis], least, most);")]),
    Mutant("noise_in_world_units", "noise is in diagonals of the mesh's box", [
        ("core/sampling/point_sampler.cpp", "near.sigma * diagonal_", "near.sigma")]),
    Mutant("points_at_infinity", "points that are not finite are told before they are drawn", [
        ("core/sampling/point_sampler.cpp", "if (!std::isfinite(lower) || !std::isfinite(upper)) return false;", "")]),
    Mutant("one_stream_for_all", "each point has a stream of random numbers of its own", [
        ("core/sampling/point_sampler.cpp", "Random random(seed_, number);", "Random random(seed_, number / 2);")]),
    Mutant("another_generator", "the generator is SplitMix64", [
        ("core/data/split_mix.h", "0x94D049BB133111EB", "0x94D049BB133111ED")]),
    Mutant("logarithm_of_few_terms", "normal numbers are those of the polar method", [
        ("core/sampling/random.cpp", "1.0 / 23, 1.0 / 21, 1.0 / 19, 1.0 / 17, 1.0 / 15, 1.0 / 13",
         "0.0, 0.0, 0.0, 0.0, 0.0, 0.0")]),

    # --- Distances ---
    Mutant("few_in_reverse", "runs are of triangles next to one another", [
        ("core/mesh/selection_kernel.cpp", "hn::Lt(hn::Load(d, &keys[other]), key)",
         "hn::Gt(hn::Load(d, &keys[other]), key)")]),
    Mutant("distances_below_the_limit_only", "a limit of 0 is reached by samples on the surface", [
        ("core/distance/tree_kernel.cpp", "reach_(beyond_error(limit)) {}", "reach_(limit) {}")]),
    Mutant("distances_of_boxes_are_exact", "a triangle's distance may be less than that of its box, by its error", [
        ("core/distance/tree_kernel.cpp", "std::min(reach_, beyond_error(least_))", "std::min(reach_, least_)")]),
    Mutant("squares_in_doubt_are_exact", "what a square is off by without care is left to the nearest triangle", [
        ("core/distance/tree_kernel.cpp", "beyond_error(beyond_error(least_of(some.values)))",
         "0.99 * least_of(some.values)")]),
    Mutant("care_never_finds_less", "squares in doubt may be less with care", [
        ("core/distance/triangle_lanes-inl.h", "hn::Sub(squares, hn::Mul(hn::Set(d, kOff), direction_from))",
         "hn::Add(squares, hn::Mul(hn::Set(d, kOff), direction_from))")]),
    Mutant("blocks_without_radius", "a block's samples are that far from its middle", [
        ("core/distance/distance_band.cpp", "std::min(band_ + radius, distance + norm(center - from))",
         "std::min(band_, distance + norm(center - from))")]),
    Mutant("searches_without_step", "the next sample is a step farther from the triangle nearest to the last one", [
        ("core/distance/distance_band.cpp", "std::min(band_, distance + norm(q - last))",
         "std::min(band_, distance)")]),
    Mutant("half_spaces_without_bend", "closest points seen from elsewhere are farther than by their direction", [
        ("core/distance/near_triangles-inl.h", "nearest.distance + bend(nearest.distance, middle.radius);",
         "nearest.distance;")]),
    Mutant("half_spaces_of_needles", "a triangle without direction may be nearer by the radius", [
        ("core/distance/near_triangles-inl.h", "hn::Max(hn::Sub(least, radius_), zero)", "least")]),
    Mutant("half_spaces_without_turn", "directions to triangles differ", [
        ("core/distance/near_triangles-inl.h", "hn::Add(within, gained)", "within")]),
    Mutant("lanes_without_care", "lanes that are not sure are evaluated again", [
        ("core/distance/block_kernel.cpp", "if (!hn::AllTrue(d, settled)) take_care(placed, n, settled, accurate, group);",
         "")]),
    Mutant("packs_without_care", "triangles of a pack that are not sure are evaluated again", [
        ("core/distance/tree_kernel.cpp", "if (!hn::AllTrue(d, settled)) doubt(pack, i, settled, bounds);", "")]),
    Mutant("no_sample_is_far", "lattices may be larger than what squares hold", [
        ("core/distance/distance.cpp", "return std::abs(to_unit(coordinate)) <= far_beyond;",
         "return std::abs(to_unit(coordinate)) <= std::numeric_limits<double>::max();")]),
    Mutant("band_ends_with_what_is_near", "samples that are not far may be farther than that from the mesh", [
        ("core/distance/distance.cpp", "const double unit_band = std::min(to_unit(band), 4 * kFar);",
         "const double unit_band = std::min(to_unit(band), kFar);"),
        ("core/distance/distance.cpp", "visit_band(nearest(), rows, std::min(to_unit(band), 4 * kFar), phase, kY, visitor);",
         "visit_band(nearest(), rows, std::min(to_unit(band), kFar), phase, kY, visitor);")]),
    Mutant("origin_has_a_size", "squares of distances to a mesh without a size underflow", [
        ("core/distance/distance.cpp", "if (is_origin) far_beyond = -1.0;", "(void)is_origin;")]),
    Mutant("distances_without_care", "next to the surface or a needle rounding shows", [
        ("core/distance/triangle_distance.cpp", "return least >= sure_from_ || least <= sure_up_to_ ?", "return least >= 0 ?")]),
    Mutant("needles_are_segments", "a thin triangle is its edges from some distance only", [
        ("core/distance/triangle_distance.cpp", "4e12 *", "4e4 *")]),
    Mutant("needles_are_proper", "beyond which edges a point lies is not known of needles", [
        ("core/distance/triangle_distance.cpp", "constexpr double kProper = 0x1p-8;", "constexpr double kProper = 1e-30;")]),
    Mutant("tiny_triangles_are_proper", "squares of small normals underflow", [
        ("core/distance/triangle_distance.cpp", "constexpr double kTiny = 1e-130;", "constexpr double kTiny = 0;")]),
    Mutant("rest_is_not_corrected", "a residual holds the error of the coordinates that it is of", [
        ("core/distance/triangle_distance.cpp", "return square(rest - dot(rest, to_v_) * edges_[0] + dot(rest, to_w_) * edges_[2]);",
         "return square(rest);")]),
    Mutant("inside_of_two_edges", "a point is inside of a thin triangle within all three edges", [
        ("core/distance/accurate_distance.cpp", "&& !(along < up * parts_.apex) &&", "&&")]),
    Mutant("inside_of_two_edges_in_lanes", "a point is inside of a thin triangle within all three edges, in lanes as well", [
        ("core/distance/accurate_lanes-inl.h", "hn::Or(along < up * apex, one - along < up * (one - apex))",
         "along < up * apex")]),
    Mutant("needles_of_other_blocks", "what is kept of a block's thin triangles is forgotten with it", [
        ("core/distance/block_kernel.cpp", "  scratch.accurate.forget_all();\n", "")]),
    Mutant("no_segments", "a triangle without height is its edges", [
        ("core/distance/accurate_distance.cpp", "constexpr double kThin = 0x1p-112;", "constexpr double kThin = 0;")]),

    # --- Rules on lattices ---
    Mutant("blocks_do_not_change", "a block is decided only if the bound of the change allows it", [
        ("core/evaluation/rule_blocks.cpp", "smooth.change + mesh_.doubt()",
         "0 * smooth.change + mesh_.doubt()")]),
    Mutant("certificate_forgets_large_values", "what is left of a large value has that value's rounding", [
        ("core/evaluation/rule_blocks.cpp", " + smooth.largest));", "));")]),
    Mutant("caps_are_not_crossed", "in blocks, crossings are those of the mesh less its caps", [
        ("core/evaluation/side_samples.cpp", "return visit(index + from, index + to, n - caps);",
         "return visit(index + from, index + to, n - 0 * caps);")]),
    Mutant("runs_end_late", "crossings of runs are those of the samples before the crossing", [
        ("core/crossings/lattice_sums.h", "upper_bound(runs_, sample, {}, &RowPrefix::samples)",
         "lower_bound(runs_, sample, {}, &RowPrefix::samples)")]),
    Mutant("enclosure_in_double", "differences to the query are exact", [
        ("core/boundary/enclosure_kernel.cpp", "const Pair y = exact_sum(hn::Set(d, v.y), hn::Neg(q.y))", "const Pair y{hn::Sub(hn::Set(d, v.y), q.y), hn::Zero(d)}")]),
    Mutant("enclosure_loses_signs", "in 113 bits, too, a factor has the sign of its side", [
        ("core/boundary/edge_factor.cpp", "if ((step.reversed ? -side.sign : side.sign) < 0) im = -im;", "")]),
    Mutant("enclosure_of_nothing", "what stands for 0 is 0 in the end", [
        ("core/boundary/enclosure.cpp", "std::abs(high) < kNoPart ?", "std::abs(high) < 0 ?")]),
    Mutant("enclosure_products_round_nothing", "a product rounds, too", [
        ("core/boundary/enclosure_kernel.cpp", "hn::Set(d, 4 * kRounding));", "hn::Zero(d));")]),
    Mutant("enclosure_is_always_plain", "near an edge z cancels, in pairs of doubles, too", [
        ("core/boundary/enclosure_kernel.cpp", "most_condition = hn::Set(d, 64.0)", "most_condition = hn::Set(d, 1e300)")]),
    Mutant("enclosure_bounds_nothing", "what a factor is off by grows with its condition", [
        ("core/boundary/enclosure_kernel.cpp", "hn::Mul(hn::Set(d, 40 * kRounding), condition)", "hn::Zero(d)")]),
    Mutant("enclosure_trusts_any_sign", "the sign of a side is sure, or that of a predicate", [
        ("core/boundary/enclosure_kernel.cpp", "hn::Gt(hn::Abs(im.high), doubt)", "hn::Eq(doubt, doubt)")]),
    Mutant("settled_by_too_rough_sums", "what the direct sum cannot tell from a critical value is enclosed", [
        ("core/evaluation/settler.cpp", "> mesh_.doubt_of_direct_values()", ">= 0.0")]),
    Mutant("settled_without_whole_turns", "values tell the whole turns of the direct sum that settles them", [
        ("core/evaluation/settler.cpp", "direct[i] += std::nearbyint(value - direct[i]);", "")]),
    Mutant("sides_are_not_settled", "a value within the doubt of a threshold is settled", [
        ("core/evaluation/side_setter.h", "return raycone::may_be_across(w, threshold, doubt_);",
         "return raycone::may_be_across(w, threshold, -2 - doubt_);")]),
    Mutant("edges_change_less", "an edge bounds the gradient by L / (4 pi d^2)", [
        ("core/boundary/change_kernel.cpp", "const Lanes of_length = hn::Div(hn::Load(d, &node.length[i]), square);",
         "const Lanes of_length = hn::Div(hn::Load(d, &node.length[i]), hn::Mul(hn::Set(d, 3.0), square));")]),
    Mutant("edges_left_out", "an edge of a needle is left out only where it is farther than rounding could hide", [
        ("core/distance/accurate_distance.cpp", "> least * (1 + 1e-12)", "> least * 0.5")]),
    Mutant("planes_left_out", "a needle's plane is left out only where its closest point is surely outside", [
        ("core/distance/accurate_distance.cpp", "up > 1.0 + off", "up > 0.5 + off")]),
    Mutant("loops_cancel_wholly", "pieces that lead there and back cancel but for how far they are apart", [
        ("core/boundary/change_bound.cpp", "moved.area += std::sqrt(square_of_diagonal(cluster.box)) * cluster.length;",
         "moved.area += 0.0;")]),
    Mutant("cracks_change_nothing", "a cap bounds the gradient by 2 A / (4 pi d^3)", [
        ("core/boundary/change_kernel.cpp", "hn::IfThenElseZero(taken, hn::Add(of_length, of_area))",
         "hn::IfThenElseZero(taken, hn::Add(of_length, hn::Mul(hn::Zero(d), of_area)))")]),
    Mutant("rough_sums_are_close", "rough sums decide only what they are not off by", [
        ("core/evaluation/rough_sides.cpp", "sums.row(j, k), off, left)", "sums.row(j, k), 0 * off, left)")]),
    Mutant("rough_ranges_are_narrow", "sums are within a range that is wider than that of values at nodes", [
        ("core/evaluation/rough_sums.cpp", "box.nodes.growth() * (most / 2 - least / 2)", "0 * (most / 2 - least / 2)")]),
    Mutant("boxes_around_are_exact", "what a box takes over is off as it was", [
        ("core/evaluation/rough_sums.cpp", "(around ? around->error : 0.0)", "(around ? 0.0 : 0.0)")]),
    Mutant("rough_sums_alone_leave_samples", "samples that rough sums do not tell are evaluated", [
        ("core/evaluation/rule_blocks.cpp", "    samples.evaluate_each(undecided);\n", "")]),
    Mutant("unopened_nodes_are_lost", "parts of a box open the nodes that it has left", [
        ("core/far/cover.cpp", "for (const std::uint32_t node : around->unopened) walk.take_node(node);", "")]),
    Mutant("smooth_nodes_do_not_bend", "interpolation of expansions is off by their derivatives", [
        ("core/far/cover.cpp", "result_.error += bend + interpolation_.growth * cut->error;",
         "result_.error += interpolation_.growth * cut->error;")]),
    Mutant("smooth_triangles_do_not_bend", "interpolation of triangles is off by their derivatives", [
        ("core/far/cover.cpp", "result_.error += bend;", "result_.error += 0 * bend;")]),
    Mutant("small_triangles_are_nothing", "what is left out is part of the error", [
        ("core/far/cover.cpp", "result_.error += solid_angle;", "result_.error += 0 * solid_angle;")]),
    Mutant("slender_triangles_are_narrower", "what a slender triangle bends grows with its width", [
        ("core/far/cover.cpp", "kOfWidth = 3 * std::numbers::pi / 8", "kOfWidth = 3e-3 * std::numbers::pi / 8")]),
    Mutant("large_triangles_are_smaller", "what a large triangle bends grows with the square of the distance", [
        ("core/far/cover.cpp", "kOfAny = std::numbers::pi / 2", "kOfAny = 1e-3 * std::numbers::pi / 2")]),
    Mutant("gaps_are_from_lines_alone", "no gap is more than the distance", [
        ("core/far/triangle_extent.cpp", "least - reach", "least - 0.5 * reach")]),
    Mutant("nodes_without_expansion_are_nothing", "a node without expansion has no bounds", [
        ("core/far/source_tree.cpp", "if (node.order == 0) return std::nullopt;", "if (node.order < 0) return std::nullopt;")]),
    Mutant("planes_are_missed", "a piece of a plane is missed only beyond the reach of the box", [
        ("core/boundary/flat_piece.cpp", "> reach + (kPlaneError", "> 0.5 * reach + (kPlaneError")]),
    Mutant("planes_are_exact", "normals and differences round", [
        ("core/boundary/flat_piece.cpp", "constexpr double kPlaneError = 0x1p-44;", "constexpr double kPlaneError = 0.0;")]),
    Mutant("pieces_underflow", "flat pieces meet blocks next to their corners", [
        ("core/boundary/flat_piece.cpp", "constexpr double kUnderflow = 0x1p-1022;", "constexpr double kUnderflow = 0.0;")]),

    # --- Self-intersections ---
    Mutant("neighbours_intersect", "what is shared does not count", [
        ("core/intersections/triangle_pair.cpp", "const std::size_t shared = shared_first(a, b);", "const std::size_t shared = shared_first(a, b) * 0;")]),
    Mutant("folds_are_flat", "neighbours that are folded onto each other count", [
        ("core/intersections/triangle_pair.cpp",
         "return orientation_in_plane(axis, from, to, s[2]) == orientation_in_plane(axis, from, to, t[2]);",
         "return ((void)axis, false);")]),
    Mutant("corners_never_cross", "the edge opposite a shared corner may meet the other triangle", [
        ("core/intersections/triangle_pair.cpp", "return meets({s[1], s[2]}, t) || meets({t[1], t[2]}, s);", "return false;")]),
    Mutant("corner_of_one_only", "either triangle may be the one that is left first", [
        ("core/intersections/triangle_pair.cpp", "return meets({s[1], s[2]}, t) || meets({t[1], t[2]}, s);",
         "return meets({s[1], s[2]}, t);")]),
    Mutant("touching_is_apart", "a corner on another triangle counts", [
        ("core/intersections/triangle_pair.cpp", "if (from * to > 0) return false;", "if (from * to >= 0) return false;")]),
    Mutant("planes_without_overlap", "an overlap in one plane counts", [
        ("core/intersections/triangle_pair.cpp",
         "return on_triangle(t[0], t[1], t[2], s.from) || meets_an_edge(s, t);", "return false;")]),
    Mutant("sides_touch_unseen", "triangles in one plane that touch count", [
        ("core/intersections/triangle_pair.cpp", "orientation_in_plane(axis, edge.from, edge.to, p) * whole < 0;",
         "orientation_in_plane(axis, edge.from, edge.to, p) * whole <= 0;")]),
    Mutant("segments_leave_any_way", "a segment meets a neighbour where it leaves the corner within it", [
        ("core/intersections/triangle_pair.cpp", "if (is_flat(s)) return starts_within(s[1], t) || starts_within(s[2], t);\n",
         "")]),
    Mutant("duplicates_are_one", "two triangles of the same corners overlap", [
        ("core/intersections/triangle_pair.cpp", "return !is_flat(a);", "return false;")]),
    Mutant("boxes_must_overlap", "boxes that touch meet", [
        ("core/intersections/box_node.h", "meeting(const HalfBox& box) const {\n    const __m128i sides = in_units(box);",
         "meeting(const HalfBox& box) const {\n    const __m128i sides = _mm_sub_epi16(in_units(box), _mm_setr_epi16(0, 0, 1, 1, 0, 1, 0, 0));")]),
    Mutant("first_of_any_thread", "the first pair is that of the tree's order", [
        ("core/intersections/self_intersections.cpp", "if (found_first.place < first.place) first = found_first;",
         "first = found_first;")]),

    # --- Orientation ---
    Mutant("doubled_quads_of_any_height", "the four faces of a tetrahedron are no quadrilateral twice", [
        ("core/orientation/doubled_quads.cpp", "height <= std::max(kFlat * longest, rounding_)", "height <= longest")]),
    Mutant("doubled_quads_that_are_walls", "walls between cells are not cut as the other side", [
        ("core/orientation/doubled_quads.cpp", "doubled < faces - faces / kPart", "doubled == 0")]),
    Mutant("copies_with_marks_of_their_order", "faces of the same corners mark the same bits, whatever their order", [
        ("core/orientation/unique_faces.cpp", "square(t[0]) + square(t[1]) + square(t[2])",
         "square(t[0]) + 3 * square(t[1]) + square(t[2])")]),
    Mutant("closed_relation_not_kept", "patches that agree as stored keep their relation", [
        ("core/orientation/closed_patches.cpp", "as_stored != 0 ? as_stored * sign[parent]",
         "as_stored == 2 ? as_stored * sign[parent]")]),
    Mutant("nesting_of_some_vertices", "a patch is nested if all of its vertices are inside", [
        ("core/orientation/nesting.cpp", "(winding == 0 ? misses : hits) = true;",
         "if (winding != 0) hits = true;")]),
    Mutant("copies_vote_for_the_first", "faces that are there both ways have no opinion", [
        ("core/orientation/unique_faces.cpp", "votes += as_first ? 1 : -1;",
         "votes += as_first ? 1 : 0;")]),
    Mutant("cut_depends_on_order", "where a patch is cut depends on coordinates only", [
        ("core/orientation/patches.cpp", "    std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.first < b.first; });\n",
         "")]),
    Mutant("patches_close_nothing", "patches that close each other at an edge are one piece", [
        ("core/orientation/pieces.cpp", "    while (join()) {\n    }\n",
         "")]),
    Mutant("volume_sign_not_exact", "the sign of a volume is exact", [
        ("core/exact/volume_sign.cpp", "(static_cast<double>(triangles) + 16.0) * 0x1p-52 * terms + 0x1p-900",
         "0.0")]),
    Mutant("volume_underflows", "the sign of a volume is exact where products underflow", [
        ("core/orientation/closed_components.cpp", "(std::abs(forth) + std::abs(back) + kVolumeUnderflow)", "(std::abs(forth) + std::abs(back))")]),
    Mutant("touching_is_within", "a vertex on another component does not tell whether it lies within", [
        ("core/orientation/nesting.cpp", "if (!sums[at].is_near) verdicts[n].clear", "verdicts[n].clear")]),
    Mutant("vertices_alone_tell", "points beside faces tell what lies within, too", [
        ("core/orientation/nesting.cpp", "points.insert(points.end(), on_faces.begin(), on_faces.end());", "")]),
    Mutant("marks_are_forgotten", "triangles of the same corners mark the same bits at their lowest vertex", [
        ("core/mesh/exterior_edges.cpp", "last_waits, last), as_marks(other_mark))", "last_waits, last), as_marks(0))")]),
    Mutant("crowded_edges_are_lost", "edges that find no place to wait are kept beside", [
        ("core/mesh/exterior_edges.cpp", "if ((next_meets | next_waits) == 0) crowd_.push_back({t.lowest, t.next, 1});",
         "")]),
    Mutant("labels_are_components", "labels that a triangle joins are one component", [
        ("core/mesh/components.cpp", "    sets.join(a, c);\n", "")]),
    Mutant("surface_is_not_the_mean", "on its own samples an open piece counts with the mean of both sides", [
        ("core/orientation/surface_field.cpp", "of_near[i] + 0.5 * points[places[i]].side",
         "of_near[i]")]),
    Mutant("flat_piece_depends_on_order", "the orientation of a flat piece depends on coordinates only", [
        ("core/orientation/closed_patches.cpp", "return first_canonical_face(surface.faces, vertices).sign;",
         "return 1;")]),
    Mutant("first_face_where_it_is_moved", "pieces too small for the sums are turned by exact coordinates", [
        ("core/orientation/open_patches.cpp", "first_canonical_face(faces, numbered_.exact)",
         "first_canonical_face(faces, vertices_)")]),
    Mutant("samples_of_met_faces_by_order", "faces that became the same are told apart by where they were", [
        ("core/orientation/surface_samples.cpp", "return canonical_face(a.corners, exact) < canonical_face(b.corners, exact);",
         "return false;")]),
    Mutant("collapsed_faces_have_a_side", "faces of which corners have met add nothing", [
        ("core/orientation/surface_field.cpp", "if (has_met_corners(t, vertices)) continue;", "")]),
    Mutant("no_cavities_in_open_bodies", "a closed patch in an open body is a cavity", [
        ("core/orientation/open_bodies.cpp", ": -signs.sign[i] * around[n];", ": signs.sign[i] * around[n];")]),
    Mutant("open_body_stored_is_forgotten", "a closed patch keeps its relation to an open body", [
        ("core/orientation/open_bodies.cpp", "as_stored != 0 ? as_stored * around[n]", "as_stored == 2 ? as_stored * around[n]")]),
    Mutant("open_body_around_one_sample", "a patch is in an open body if all of its samples are", [
        ("core/orientation/open_bodies.cpp", "*least > 0.5 ? 1", "*most > 0.5 ? 1")]),
    Mutant("cavity_without_its_content", "what lies in a patch is turned with it", [
        ("core/orientation/open_bodies.cpp", "if (reversed[signs.outermost[i]])", "if (reversed[i])")]),
    Mutant("innermost_is_outermost", "a patch alternates with the innermost one around it", [
        ("core/orientation/nesting_tree.cpp", "depth_[a] > depth_[b]", "depth_[a] < depth_[b]")]),
    Mutant("nesting_of_mutual_patches", "patches that are around each other are not within each other", [
        ("core/orientation/nesting_tree.cpp", "mutual[i].push_back(j);", "continue;")]),
    Mutant("nesting_circles_by_order", "where circles of patches begin depends on coordinates only", [
        ("core/orientation/nesting_tree.cpp", "places_.is_before(a, b);", "a < b;")]),
    Mutant("chains_of_one", "two pieces are turned where one alone does not help", [
        ("core/orientation/sign_problem.cpp", "kLongest = 32;", "kLongest = 1;")]),
    Mutant("products_of_one_side", "what a turn does to pieces before it counts as well", [
        ("core/orientation/sign_problem.cpp", "[p * count + q] = products_[q * count + p];", "[p * count + q] = 0.0;")]),

    # --- Surfaces ---
    Mutant("surface_hit_without_edges", "a lattice edge that passes through an edge of a triangle meets it", [
        ("core/cells/edge_crossing.cpp", "first * third >= 0 && second * third >= 0", "first * third > 0 && second * third > 0")]),
    Mutant("surface_turned", "loops around three inside nodes run the other way", [
        ("core/contour/contour.cpp", "    if (!lone_inside) positive = !positive;\n", "")]),
    Mutant("surface_polygons_turned", "polygons in cells have what is inside behind their fronts", [
        ("core/contour/cell_polygons.cpp", "return outward * turn < 0;", "return outward * turn > 0;")]),
    Mutant("surface_polygons_open", "a point is left out where neither cell needs it", [
        ("core/contour/contour_parts.h", "edges[n] | (above[n] & below[n])",
         "edges[n] | above[n] | below[n]")]),
    Mutant("surface_polygons_without_corners", "polygons in cells meet in corners of the mesh", [
        ("core/contour/cell_polygons.cpp", "has_apex_ = ends.one.has_value();", "has_apex_ = false;")]),
    Mutant("surface_places_on_border", "a vertex on the border of its edge, face or cell is out of place", [
        ("core/contour/vertex_places.cpp", "!(last - here >= margin_ / 2)", "!(last - here >= 0.0)")]),
    Mutant("surface_places_off_faces", "a vertex beside its edge or face is out of place", [
        ("core/contour/vertex_places.cpp", "<= margin_ / 16)", "<= 1.0)")]),
    Mutant("surface_creases_cut_off", "a sharp edge is followed up to where it leaves the cells", [
        ("core/contour/contour.cpp", "if (!point && points.face_points == 1)", "if (!point && points.face_points == 9)")]),
    Mutant("surface_corners_cut_off", "an apex lies on a corner of the mesh", [
        ("core/cells/cell_creases.cpp", "is_within(from_first, margin)) nearest.add", "is_within(from_first, 9.0 + margin)) nearest.add")]),
    Mutant("surface_planes_only", "a face point lies on a sharp edge even where planes do not meet there", [
        ("core/contour/face_points.cpp", "return meeting ? meeting : crease_point(*edges, creases, surface.margin);",
         "return meeting;")]),
    Mutant("surface_sections_turned", "both sides of a face have its points in one order", [
        ("core/contour/contour.cpp", "(last < next ? n : count - 1 - n)", "n")]),
    Mutant("surface_sections_by_triangles", "flat parts of several triangles are one piece of a section", [
        ("core/cells/cell_creases.cpp", "    if (bits == 0) parts.join(first.face, last.face);\n", "")]),
    Mutant("surface_sections_of_cones", "faces have several points only where polygons are", [
        ("core/contour/face_points.cpp", "return cells_of_polygons[cell] != 0;", "return cells_of_polygons[cell] < 9;")]),
    Mutant("nodes_counted_once", "nodes that a mesh went around twice have not changed sides", [
        ("core/certificate/certificate.cpp", "Rule{RuleKind::kOdd}, lattice)", "Rule{RuleKind::kNonzero}, lattice)")]),
    Mutant("rows_of_a_change", "nodes are looked for in all rows that a change may pass", [
        ("core/certificate/certificate.cpp", "lattice.cell_at(axis, box.upper[axis]) + 2", "lattice.cell_at(axis, box.upper[axis]) - 1")]),
    Mutant("faults_that_stay", "faces that intersected others are looked at again", [
        ("core/merging/repeated_check.cpp", "again[now] = same && faulty_[before];", "again[now] = false;")]),
    Mutant("faces_beside_gone_ones", "faces at corners of those that have changed are looked at", [
        ("core/merging/repeated_check.cpp", "if (was_there && !same) touch(triangles_[before]);", ""),
        ("core/merging/repeated_check.cpp", "if (!same) touch(merged.triangles[now]);", "")]),
    Mutant("surface_pulled_off_planes", "merging keeps vertices in the planes of all faces around", [
        ("core/merging/patch_merger.cpp", "return planes_[plane].distance(p) <= limits_.most;",
         "return planes_[plane].distance(p) <= 1e9 * limits_.most;")]),
    Mutant("bricks_own_borders", "vertices that have faces in two bricks are neither's", [
        ("core/merging/surface_bricks.cpp", "if (!is_own) of_corner.store(SurfaceBricks::kNone, std::memory_order_relaxed);", "(void)is_own;")]),
    Mutant("settled_at_borders", "what a brick may not be pulled into, another may", [
        ("core/merging/patch_merger.cpp", "    if (roles_[target] == VertexRole::kForeign) {\n      by_geometry = false;\n",
         "    if (roles_[target] == VertexRole::kForeign) {\n")]),
    Mutant("far_faces_keep_sources", "simplified faces that reach into a hole are of no triangle", [
        ("core/surface/face_sources.cpp", "return distances[corner] > most;", "return distances[corner] > 1e9 * most;")]),
    Mutant("groups_are_far_as_points", "points around one that is dropped are not all dropped", [
        ("core/surface/dropped_samples.cpp", "of_middles[n] > group.radius + farthest_", "of_middles[n] > farthest_")]),
    Mutant("farthest_by_source_alone", "a vertex may be farther from the mesh than the others whose sources are", [
        ("core/surface/surface_measures.cpp",
         "largest = std::max(largest, from_source + near_rounding < distances[n] ? from_source : distances[n]);",
         "largest = n == 0 ? std::max(largest, distances[n]) : largest;")]),
    Mutant("far_parts_round_measures", "what is far from the lattice costs distances their digits", [
        ("core/surface/surface_measures.cpp", "from_source + near_rounding < distances[n] ? from_source : distances[n]",
         "distances[n]")]),
    Mutant("corner_to_the_last_vertex", "of several corners near one vertex the nearest has it", [
        ("core/merging/mesh_corners.cpp", "return std::pair(move.vertex, move.square);",
         "return std::pair(move.vertex, -move.square);")]),
    Mutant("groups_by_cut_names", "names that begin alike are names of several groups", [
        ("io/mesh/face_groups.cpp", "return groups_.names[entry.second] == text && missing_[entry.second] == missing;",
         "return groups_.names[entry.second] == text;"),
        ("io/mesh/face_groups.cpp", "const std::uint64_t hash = joined(hash_of(text), missing);",
         "const std::uint64_t hash = hash_of(text);")]),
    Mutant("beside_by_one_corner", "a line tells triangles apart where all that is not shared is beyond it, for many, too", [
        ("core/intersections/triangle_pair.cpp", "beside &= (left - right < -trust) | is_start | is_end;",
         "beside = (left - right < -trust) | is_start | is_end;")]),
    Mutant("graph_around_twice", "faces that go around a vertex twice may meet", [
        ("core/intersections/vertex_graph.cpp", "return rounds == 1;", "return rounds >= 1;")]),
    Mutant("graph_seen_from_behind", "faces that are folded over others are seen from behind", [
        ("core/intersections/vertex_graph.cpp", "if (!turns_left(direction, a, b)) return false;", "")]),
    Mutant("unsettled_far_off", "values that are not settled are those of the sum", [
        ("core/evaluation/scaled_mesh.cpp", "if (settling == Settling::kLeft) return;",
         "if (settling == Settling::kLeft) {\n    values[0] += 1e-9;\n    return;\n  }")]),
    Mutant("apart_by_one_corner", "a line tells triangles apart where all that is not shared is beyond it", [
        ("core/intersections/triangle_pair.cpp", "if (std::all_of(t.begin()", "if (std::any_of(t.begin()")]),
    Mutant("merged_or_not_at_all", "around nodes on the wrong side nothing is merged, elsewhere all", [
        ("core/merging/kept_vertices.cpp", "has_misplaced && is_beside(", "has_misplaced && 0 > 1 && is_beside(")]),
    Mutant("points_beside_corners", "faces between corners of the mesh are in its planes exactly", [
        ("core/merging/mesh_corners.cpp", "if (move.vertex != last) vertices[move.vertex] = move.to;", "")]),
    Mutant("points_beside_level_planes", "points of faces in level planes are in these exactly", [
        ("core/merging/mesh_corners.cpp", "if (std::abs(here - a[axis]) <= reach) here = a[axis];", "")]),
    Mutant("once_around_twice", "a polygon that ends where it starts has that corner once", [
        ("core/contour/cell_polygons.cpp", "last.corners[last.size - 1]) --last.size;", "last.corners[last.size - 1]) last.size += 0;")]),
    Mutant("beside_nodes_unseen", "points of the lattice's edges are on the surface of one that is moved", [
        ("core/surface/surface_beside_nodes.cpp", "return std::ranges::max(distances) <= off;", "return std::ranges::max(distances) >= 0.0;")]),
    Mutant("blades_are_eaten", "a ridge is held where planes meet at less than 30 degrees", [
        ("core/merging/patch_merger.cpp", "kBackToBack = -0.866;", "kBackToBack = -1 + 0x1p-21;")]),
    Mutant("hits_by_rounding", "where a segment is nearly in a plane, the place where it meets that is exact", [
        ("core/cells/edge_crossing.cpp", "kSure = 0x1p-10;", "kSure = 0;")]),
    Mutant("sectors_end_anywhere", "a line between sectors leads to the nearest corner of the loop on it", [
        ("core/sharpening/fill_gap.cpp", "ends.push_back(nearest_end(run.first, corner));",
         "ends.push_back(0 * nearest_end(run.first, corner) + run.first + count);")]),
    Mutant("corners_without_rings", "faces that reach beyond a corner are part of the gap there", [
        ("core/sharpening/corner_gaps.cpp", "is_off(face) || std::ranges::any_of(", "is_off(face) && std::ranges::any_of(")]),
    Mutant("planes_from_either_side", "a plane that has faces on both sides is two", [
        ("core/sharpening/fill_gap.cpp", "return dot(label.plane.normal, plane.normal) > 0.0 &&",
         "return dot(label.plane.normal, plane.normal) != 0.0 &&")]),
    Mutant("faulty_fills_come_again", "where a fill has faults, the next one is tried", [
        ("core/sharpening/corner_gaps.cpp", "++passed_over[numbers[n]];", "passed_over[numbers[n]] += 0;")]),
    Mutant("bubbles_in_solids", "what is within a solid, or inside out beside it, is no part of its border", [
        ("core/certificate/border_components.cpp", "is_border[n] = !holds(rule, front) && holds(rule, behind);",
         "is_border[n] = true;")]),
    Mutant("meshes_unrounded", "a mesh that is kept is rounded to single precision, too", [
        ("core/filling/mesh_border.cpp", "  round_to(options.precision, itself.mesh.vertices);\n",
         "")]),
    Mutant("unseen_components_kept", "each component must be in a cell with nodes of both kinds", [
        ("core/filling/seen_by_nodes.cpp", "if (!mixed.are_met_by(component, vertices)) return Sight::kUnseen;", "")]),
    Mutant("far_parts_kept", "no part of a mesh may be far from nodes of both kinds", [
        ("core/filling/seen_by_nodes.cpp", "!mixed.are_near_to(t, vertices); }) ? Sight::kInPart", "!mixed.are_near_to(t, vertices); }) ? Sight::kWhole")]),
    Mutant("faces_cut_apart_once", "edges of faces cross each other in a plane, too", [
        ("core/arrangement/plane_arrangement.cpp", "if (cross_each_other(s, t, axis, points)) found", "if (n > m) found")]),
    Mutant("steps_of_each_alone", "what all threads do together is limited", [
        ("core/arrangement/effort.h", "return taken < most && effort.take(taken);", "return true;")]),
    Mutant("multiplicity_forgotten", "two faces that lie on each other change winding numbers by two", [
        ("core/arrangement/plane_arrangement.cpp", "*face, std::abs(multiplicity[n])", "*face, 1")]),
    Mutant("corners_of_faces_missed", "a corner of one face on another is a point of both", [
        ("core/arrangement/contact.cpp", "if (sides[i] == 0 && on_triangle", "if (sides[i] == 2 && on_triangle")]),
    Mutant("rays_count_edges", "another point is tried where a ray meets an edge", [
        ("core/arrangement/winding_in_front.cpp", "if (meeting.at_edge) at_edges[i] = true;", "")]),
    Mutant("borders_face_in", "where the rule holds in front of faces, the border faces the other way", [
        ("core/arrangement/rule_border.cpp", ": Place::kTurned);", ": Place::kAsItIs);")]),
    Mutant("solids_meet_through_edges", "faces at an edge belong together where the solid is between them", [
        ("core/arrangement/face_pairs.cpp", "(*order)[(n + order->size() - 1) % order->size()]", "(*order)[(n + 1) % order->size()]")]),
    Mutant("fans_cross", "fans that go ahead at one end of an edge pass those that do at the other", [
        ("core/arrangement/fan_parting.cpp", "if (does) return way;", "if (does && axis > 2) return way;"),
        ("core/arrangement/fan_parting.cpp", "kFarther = 1.25;", "kFarther = 1.0;")]),
    Mutant("fans_leave_planes", "fans move along one axis where that is enough", [
        ("core/arrangement/fan_parting.cpp", "if (does) return way;", "if (does && axis > 2) return way;")]),
    Mutant("faults_stay", "where parts that were taken apart have faults, they go another way", [
        ("core/filling/embedded_border.cpp", "++in_vain[v];", "")]),
    Mutant("copies_are_themselves", "vertices of parts are known as copies", [
        ("core/arrangement/take_apart.cpp", "add_vertex(at, vertex)",
         "add_vertex(at, static_cast<std::uint32_t>(border_.vertices.size()))")]),
    Mutant("places_cancel", "places next to a plane are right", [
        ("core/cells/edge_crossing.cpp", "constexpr double kWideSure = 0x1p-58;", "constexpr double kWideSure = 0.0;")]),
    Mutant("needles_cancel", "gradients next to the lines of sides are those of exact differences", [
        ("core/exact/direct_gradient.cpp", "kCancels = 0x1p-60;", "kCancels = 0.0;")]),
    Mutant("far_sides_are_lost", "gradients from far away are those of the definition", [
        ("core/exact/direct_gradient.cpp", "constexpr double kFar = 0x1p80;", "constexpr double kFar = 0x1p999;")]),
    Mutant("cavities_go_in", "a vertex moves away from the other parts that touch it", [
        ("core/arrangement/fan_cone.cpp", "return are_on_one_side(*way, other); })", "return are_on_one_side(*way, other) && false; })")]),
    Mutant("flat_triangles_stay", "sides that corners are near to are split there", [
        ("core/arrangement/snap.cpp", "if (height > distance) return std::nullopt;", "if (height > 0.0 * distance) return std::nullopt;")]),
    Mutant("walls_stay", "triangles that are one in either direction are gone", [
        ("core/arrangement/snap.cpp", "if (more * faces[n].direction <= 0) continue;", "if (more * faces[n].direction < 0) continue;")]),
    Mutant("corners_on_faces_stay", "faces that corners are near to are cut there", [
        ("core/arrangement/snap.cpp", "border.mesh.triangles[face] = {t[0], t[1], v};", "continue;")]),
    Mutant("parts_meet_beside_nodes", "a part moves away from the others", [
        ("core/arrangement/fan_cone.cpp", "return goes_away({}, way) && std::ranges::all_of", "return !goes_away({}, way) || std::ranges::all_of")]),
    Mutant("edges_moved_at_one_end", "of two parts the same one moves along all of an edge", [
        ("core/arrangement/fan_cone.cpp", "sum += dot(across, way)", "sum -= 0.0 * dot(across, way)")]),
    Mutant("caps_as_they_are", "faces of caps are divided until they are along the threshold", [
        ("core/filling/fit_to_threshold.cpp", "if (bent.empty()) return true;", "if (bent.empty() || true) return true;")]),
    Mutant("beside_the_threshold", "new vertices are where w is the threshold", [
        ("core/cells/line_roots.cpp", "if (!bracket.at_jump) return bracket.root;", "if (!bracket.at_jump) return 1.001 * bracket.root;")]),
    Mutant("jumps_of_half_a_turn", "rules that fold w jump by less", [
        ("core/cells/edge_roots.cpp", "kJump = 0x1p-8;", "kJump = 0x1p-1;")]),
    Mutant("roots_are_jumps", "where values reach 0 they do not jump, however far the other end is", [
        ("core/cells/edge_roots.cpp", "at_jump = !is_met_ && std::abs", "at_jump = std::abs")]),
    Mutant("fills_on_faces", "no vertex of a fill is on a face of the mesh", [
        ("core/cells/line_roots.cpp", "std::min(behind / length,", "std::min(0.0 * behind / length,")]),
    Mutant("nodes_of_holes_unseen", "nodes next to what closes a hole are on their sides", [
        ("core/filling/fit_to_threshold.cpp", "fits = misplaced.empty();", "fits = true;")]),
    Mutant("other_evaluators_in_scale", "scaled meshes have evaluators with the same accuracies", [
        ("core/surface/surface_in_scale.cpp", "evaluator.asked_accuracy()", "(void(evaluator), Accuracy{})")]),
    Mutant("islands_inside_out", "the part that a node gets has the node on its side", [
        ("core/filling/fit_to_threshold.cpp", "nodes[n].is_inside ? Fronts::kOutward", "!nodes[n].is_inside ? Fronts::kOutward")]),
    Mutant("sheets_are_thick", "what ends within half a voxel behind a sheet is too thin", [
        ("core/filling/fill_check.cpp", "constexpr double kStep = 0.5, kAside = 0x1p-20, kThin = 0.5;", "constexpr double kStep = 0.5, kAside = 0x1p-20, kThin = 0.001;")]),
    Mutant("any_filling", "what closes holes must be near to the threshold", [
        ("core/filling/fill_check.cpp", "constexpr double kLittle = 1.0,", "constexpr double kLittle = 1e9,")]),
    Mutant("sides_of_changed_faces_stay", "sides of faces that have changed are found anew", [
        ("core/filling/fill_faces.cpp", "std::erase_if(sides_, [&](const Side& s) { return !is_old[s.face]; });", "")]),
    Mutant("edges_come_twice", "an edge that is there already is not made by a flip", [
        ("core/filling/fill_faces.cpp", "std::max(one, other)}).second) return false;", "std::max(one, other)}).second && false) return false;")]),
    Mutant("rounded_as_exact", "turns that doubles are not sure of are decided exactly", [
        ("core/exact/exact_points.cpp", "const double trust = 0x1p-48 * most * (sides + 0x1p-48 * most) + 0x1p-1000;", "const double trust = 0.0 * most * sides;")]),
    Mutant("inner_walls_are_thin_parts", "what separates nothing is not too thin for the lattice", [
        ("core/surface/surface_measures.cpp", "holds[2 * i] != holds[2 * i + 1]", "true")]),
    Mutant("simplify_forgets", "distances that a face moved by add up", [
        ("core/merging/simplify.cpp", "off_[face] = by.off;", "off_[face] = 0.0;")]),
    Mutant("simplify_at_vertex_only", "faces before and after differ most where edges cross, too", [
        ("core/merging/star_change.cpp", "if (j == i || j == target_) continue;", "if (j == i || j == target_ || j < 99) continue;")]),
    Mutant("simplify_over_nodes", "no node lies between faces before and after", [
        ("core/merging/star_change.cpp", "if (!before || !after) return false;", "return false;")]),
    Mutant("nearest_is_any_of_several", "of triangles that are equally near, the first is the nearest", [
        ("core/distance/distance_tree.cpp", "first = std::min(first, triangles_[", "first = (triangles_[")]),

    # --- The gradient ---
    Mutant("gradient_next_to_edges", "next to an edge doubles lose the vector", [
        ("core/evaluation/gradient_kernel.cpp", "kNear = 0x1p-16", "kNear = 0.0")]),
    Mutant("gradient_obtuse", "where the angle is obtuse |A| |B| + A B cancels", [
        ("core/evaluation/gradient_kernel.cpp", "is_obtuse = hn::Lt(ab, hn::Zero(d))", "is_obtuse = hn::Lt(ab, ab)")]),
    Mutant("gradient_joins_what_is_apart", "a chain of edges may end, and another one begin elsewhere", [
        ("core/evaluation/gradient_kernel.cpp", "if (!segment.joined) last", "if (&segment == &segments[0]) last")]),
    Mutant("gradient_of_huge_products", "products of four lengths overflow", [
        ("core/evaluation/gradient_kernel.cpp", "kLeast = 0x1p-200, kMost = 0x1p200", "kLeast = 0x1p-900, kMost = 0x1p900")]),

    # --- Lattices with other axes ---
    Mutant("mirrored_block_begins_at_its_end", "index i of a mirrored axis is -i along the world's", [
        ("core/data/placed_lattice.cpp", "mirrored[a] ? -last : indices.first[a]",
         "mirrored[a] ? -indices.first[a] : indices.first[a]")]),
    Mutant("mirrored_values_from_the_start", "values of a mirrored axis are sorted from its end", [
        ("core/data/placed_lattice.cpp", "    if (mirrored[a]) walk.start += (indices.counts[a] - 1) * pitch;\n", "")]),
    Mutant("nearly_an_axis", "an axis that is the world's but for a little is none of them", [
        ("core/data/placed_lattice.cpp", "if (step[static_cast<int>(a)] == 0.0) continue;",
         "if (std::abs(step[static_cast<int>(a)]) < 1e-12) continue;")]),

    # --- The far field ---
    Mutant("moments_off", "moments of triangles are integrals along their edges", [
        ("core/far/multipole.cpp", "const double factor = -1 / (kFourPi * (n + 1));",
         "const double factor = -1.01 / (kFourPi * (n + 1));")]),
    Mutant("tail_too_small", "what is beyond the last degree is within its bound", [
        ("core/far/multipole.cpp", "return kUp * area / kFourPi * power", "return 0.99 * area / kFourPi * power")]),
    Mutant("norm_too_small", "a degree is within the norm of its moments", [
        ("core/far/multipole.cpp", "bounds.size[i] = kUp * std::sqrt(square)",
         "bounds.size[i] = 0.99 * std::sqrt(square)")]),
    Mutant("shifts_off", "a node has the moments of its children, shifted to its centre", [
        ("core/far/source_tree.cpp", "(1 / node.unit) * (part.centre - node.centre)",
         "(1.01 / node.unit) * (part.centre - node.centre)")]),
    Mutant("radius_too_small", "no point of a node is farther from its centre than its radius", [
        ("core/far/source_tree.cpp", "  node.radius *= 1 + kRounding;", "  node.radius *= 0.99;")]),
    Mutant("area_too_small", "a node has the area of its triangles", [
        ("core/far/source_tree.cpp", "  node.area *= 1 + kSumRounding;", "  node.area *= 0.99;")]),
    Mutant("bends_less", "derivatives of a piece are at most k! L / (4 pi d^(k+1))", [
        ("core/boundary/change_kernel.cpp", "of_length = hn::Mul(of_length, inverse);",
         "of_length = hn::Mul(hn::Set(d, 0.1), hn::Mul(of_length, inverse));")]),
    Mutant("interpolation_is_exact", "an interpolated block is decided only if the bound of its bend allows it", [
        ("core/evaluation/rule_blocks.cpp", "const double needed = smooth.nodes->bend() + ", "const double needed = ")]),
    Mutant("polynomials_are_closer", "a polynomial is off by the product of the distances from its nodes", [
        ("core/evaluation/lattice_polynomial.cpp", "product_ * derivative", "product_ / 8 * derivative")]),
    Mutant("parts_do_not_change", "a part of an interpolated block is decided only if the change in it allows it", [
        ("core/evaluation/rule_blocks.cpp", "const double change = radius * smooth.gradient", "const double change = 0 * radius * smooth.gradient")]),
    Mutant("interpolation_with_wrong_weights", "a sample has the weights of its place in the block", [
        ("core/evaluation/lattice_polynomial.cpp", "x.weights(0).data() + (part.begin[0] - begin_[0])",
         "x.weights(0).data()")]),

    # --- Blocks of lattices ---
    Mutant("dipole_error_too_small", "a far source is within the certified error of its fit", [
        ("core/far/harmonic_error.cpp", "(is_beyond_next ? 1 : 0)].error;", "(is_beyond_next ? 1 : 0)].error / 8;")]),
    Mutant("levels_forget_what_is_spent", "what is far at all levels together keeps the budget", [
        ("core/far/lattice_blocks_walk.cpp", "block.spent += far.error;", "block.spent = far.error;")]),
    Mutant("nodes_that_are_not_moved", "what rounding of a fit's nodes changes is within the tolerance", [
        ("core/far/lattice_blocks_walk.cpp", "return kPerWay * moved / (gap * gap * gap);",
         "return 0 * kPerWay * moved / (gap * gap * gap);")]),
    Mutant("leaves_as_harmless_as_their_last", "all triangles of a leaf count for its error", [
        ("core/far/lattice_blocks_walk.cpp", "error += error_of(blocks_.sources_[triangles[end++]], cube, moved);",
         "error = error_of(blocks_.sources_[triangles[end++]], cube, moved);")]),
    Mutant("block_values_not_settled", "a value of a block that may be a half-integer is evaluated again", [
        ("core/evaluation/lattice_far.cpp", "if (doubtful != 0)", "if (doubtful < 0)")]),
    Mutant("cells_without_their_ends", "the cube of a block of cells has all points in them", [
        ("core/far/lattice_blocks_walk.h", "axes_[axis][axes_of_ == AxesOf::kCells ? last : last - 1]",
         "axes_[axis][last - 1]")]),
    Mutant("patches_without_crossings", "a patch that is summed by its boundary has the crossings of its triangles, too", [
        ("core/far/lattice_covers.cpp", "if (steps) add_crossings(cover.triangles, samples, sums);", "")]),
    Mutant("boundaries_without_orientation", "edges that triangles run along in opposite directions cancel", [
        ("core/far/shared_edges.cpp", "multiplicity += side.reversed ? -1 : 1;", "multiplicity += 1;")]),
    Mutant("rows_of_a_tile_alike", "each row of a tile has its own projections", [
        ("core/boundary/edge_lanes-inl.h", "projections.row = i / 8;", "projections.row = i / 16;")]),
    Mutant("point_values_not_settled", "a value of blocks of points that may be a half-integer is evaluated again", [
        ("core/evaluation/scaled_mesh.cpp", "values, choice_.doubt_of_blocks());", "values, -1.0);")]),
    Mutant("rims_are_pulled", "the rim of a fin, and the border of a hole, stay where planes do not hold them", [
        ("core/merging/patch_merger.cpp", "if (rim.empty()) return true;", "return true;")]),
    Mutant("sharpened_off_the_mesh", "strips are pulled together only where the mesh has an edge", [
        ("core/sharpening/fill_gap.cpp", "return d <= off;",
         "return d <= 1e9 * off;")]),
    Mutant("crossings_leave_the_mesh", "what is pulled crosses mixed edges on the mesh only", [
        ("core/sharpening/mixed_edges.cpp", "if (off.empty()) return {};", "return {};")]),
    Mutant("gaps_from_the_shortest_run_on", "where one way to fill a gap leads nowhere, another one is tried", [
        ("core/sharpening/fill_gap.cpp", "if (++tries_ > kMostTries) return false;", "if (++tries_ > 1) return false;")]),
    Mutant("faults_among_changed_faces_only", "faults are looked for between changed faces and all others", [
        ("core/certificate/certificate.cpp", "cells.meets(range_of(mesh.triangles[face]))",
         "std::ranges::find(change.faces, face) != change.faces.end()")]),
    Mutant("pulls_add_up", "merging stays near all points that are gone", [
        ("core/merging/checked_merge.cpp", "if (behind.empty())", "if (!behind.empty() || behind.empty())")]),
    Mutant("third_powers_underflow", "sources so near that powers of distances underflow have no bound", [
        ("core/boundary/change_kernel.cpp", "constexpr double kLeastSquare = 0x1p-660;",
         "constexpr double kLeastSquare = 0x1p-900;")]),
    Mutant("bricks_not_merged_again", "bricks in which something else is kept are merged again", [
        ("core/merging/merge_planes.cpp", "if (kept[v] != kept_[v]) changed.push_back(v);",
         "if (kept[v] != kept_[v] && v % 2 == 0) changed.push_back(v);")]),
    Mutant("sources_of_parallel_planes", "a face that is far from its source's plane gets another source", [
        ("core/surface/face_sources.cpp", "p - point)) <= off_;", "p - point)) <= 1e9 * off_;")]),
    Mutant("small_triangles_without_turns", "products of eight small triangles are counted as they turn", [
        ("core/far/chunk_lanes-inl.h", "times(load(products, block.i), re, im, hn::CopySignToAbs(hn::Set(d, 1.0), im))",
         "times(load(products, block.i), re, im, hn::Zero(d))")]),
    Mutant("small_triangles_too_near", "a triangle looks small beyond its longest side only", [
        ("core/far/shared_corners.cpp", "return square * (1 + 0x1p-40);", "return 0.9 * square;")]),
    Mutant("small_nodes_too_near", "triangles of a node look small from beyond its radius and their longest side only", [
        ("core/far/source_tree.cpp", "const double distance = node.radius + std::sqrt(longest);",
         "const double distance = 0.0 * node.radius * std::sqrt(longest);")]),
]
