// Indices in the palette of figures. Private to the report room.
#pragma once

namespace goingrate {

inline constexpr int blue = 0, vermilion = 1, green = 2, purple = 3, orange = 4;

} // namespace goingrate
