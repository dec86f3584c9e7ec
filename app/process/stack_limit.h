// The stack that the system grants (ulimit -s).
#pragma once

namespace raycone {

// Raises a small limit as far as it may be, for this process, the threads that it starts and its children. False where
// it stays too small, which would end in a fault: then a line has been written to standard error, in a way that needs
// next to no stack itself. To be called first.
[[nodiscard]] bool ensure_stack();

}  // namespace raycone
