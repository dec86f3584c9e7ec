// The version, the commit it was configured from, and the versions of the libraries found then.
#pragma once

namespace raycone {

extern const char* const kVersion;      // "1.0.0-rc4"
extern const char* const kCommit;       // "commit 0123456789ab"
extern const char* const kLibraries;    // "CGAL 5.5.1, Embree 3.13.5, ..."
extern const char* const kReleaseDate;  // of this version, "2026-11-21"

}  // namespace raycone
