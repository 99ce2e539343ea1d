/* Draws a relief as if light fell on it from the upper left. Pure: depths in, grey levels out. */

const PIXELS_OF_FOCUS = 140; /* a camera of about 60 degrees at 160 columns */
const EDGE_MM = 30;          /* a step that is no slope, but another surface behind */
const LIGHT = [-0.45, -0.6, 0.66];

function slope(before, here, after) {
    const a = before && Math.abs(here - before) < EDGE_MM ? here - before : null;
    const b = after && Math.abs(after - here) < EDGE_MM ? after - here : null;
    if (a !== null && b !== null) {
        return (a + b) / 2;
    }
    return a ?? b ?? 0;
}

/* The median of the depths that were measured, so that what is far behind can be left out. */
function nearest(depth) {
    const sorted = depth.filter((mm) => mm > 0).sort();
    return sorted.length ? sorted[Math.floor(sorted.length * 0.05)] : 0;
}

/* Brightness of each point, 0..255; 0 where nothing was measured, or where it is more than `deep_mm`
 * behind the nearest surface. `mirrored`: the picture will be turned, so that light has to come from
 * the other side. */
export function shade(depth, columns, rows, {mirrored = false, deepMm = 400} = {}) {
    const side = mirrored ? -1 : 1;
    const out = new Uint8Array(columns * rows);
    const far = nearest(depth) + deepMm;
    const focus = PIXELS_OF_FOCUS * columns / 160;
    for (let row = 0; row < rows; row += 1) {
        for (let column = 0; column < columns; column += 1) {
            const i = row * columns + column;
            const mm = depth[i];
            if (!mm || mm > far) {
                continue;
            }
            const pitch = mm / focus; /* millimetres from point to point */
            const x = slope(column ? depth[i - 1] : 0, mm, column + 1 < columns ? depth[i + 1] : 0) / pitch;
            const y = slope(row ? depth[i - columns] : 0, mm, row + 1 < rows ? depth[i + columns] : 0) / pitch;
            /* The normal that looks at the camera is (x, y, -1); light comes from before it. */
            const light = (x * side * LIGHT[0] + y * LIGHT[1] + LIGHT[2]) / Math.hypot(x, y, 1);
            out[i] = Math.round(40 + 215 * Math.max(0, Math.min(1, light)));
        }
    }
    return out;
}
