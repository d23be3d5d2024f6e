// Tables of the clear sky by turbidity 1 to 10.
#pragma once

namespace aerosol::render {

/// The nine coefficients of F, by turbidity, albedo of the ground (0, 1), control point of a Bézier curve over the cube
/// root of the sun's elevation (horizon to zenith), and channel.
extern const float skyShapes[10][2][6][3][9];
/// The mean radiance that F is relative to, likewise.
extern const float skyMeans[10][2][6][3];
/// The mean radiance of the sun's disc, at elevations of 2, 5, ..., 89 degrees.
extern const float sunMeans[10][30][3];

}  // namespace aerosol::render
