// The elevations of real heads' beams, from their data sheets. One name a head: --head of simulate_drive.
//
//   hdl64e:   64 beams, 32 upper ones from +2 deg in steps of 1/3 deg, 32 lower ones from -8.83 deg in steps of 1/2 deg
//   hdl32e:   32 beams from -30.67 to +10.67 deg in steps of 4/3 deg
//   vlp32c:   32 beams from -25 to +15 deg, the middle ones in steps of 1/3 deg
//   vlp16:    16 beams from -15 to +15 deg in steps of 2 deg
//   os1_64:   64 beams from -22.5 to +22.5 deg, evenly (Ouster OS1, 45 deg of view)
//   os1_128:  128 beams, likewise
//   pandar64: 64 beams from -25 to +15 deg, from -6 to +2 deg in steps of 1/6 deg (Hesai Pandar64)
#pragma once

#include <string>
#include <vector>

namespace fail_aware {

/// In the order of the list above.
std::vector<std::string> lidarHeadNames();

/// deg, from below. None: no such head.
std::vector<double> lidarHeadElevationsDeg(const std::string& head);

}  // namespace fail_aware
