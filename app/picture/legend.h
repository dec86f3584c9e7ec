// The colour bar with its numbers.
#pragma once

#include "app/picture/colour_map.h"
#include "app/picture/image.h"

namespace raycone {

// Draws it into the corner of `image` where it hides least of `drawn`, which has the size of `image`; not at all into a
// picture that it would fill.
void add_legend(Image& image, const Coverage& drawn, const ColourMap& colours);

}  // namespace raycone
