/* Draws a relief in shades of grey, with light from the upper left. */

import {h} from '../base/dom.js';
import {shade} from '../stream/shade.js';

/* A canvas, and draw(record, mirrored) for it; draw(null) shows nothing. The style sheet turns a
 * mirrored picture. */
export function reliefView(label) {
    const canvas = h('canvas', { width: 160, height: 120, role: 'img', 'aria-label': label, class: 'relief' });
    const context = canvas.getContext('2d');
    return {
        element: canvas,
        draw(record, mirrored = false) {
            if (!record) {
                context.clearRect(0, 0, canvas.width, canvas.height);
                return;
            }
            const { columns, rows, depth } = record;
            if (canvas.width !== columns || canvas.height !== rows) {
                canvas.width = columns;
                canvas.height = rows;
            }
            const light = shade(depth, columns, rows, { mirrored });
            const image = context.createImageData(columns, rows);
            light.forEach((value, i) => {
                image.data.set([value * 0.92, value * 0.97, value, value ? 255 : 0], 4 * i);
            });
            context.putImageData(image, 0, 0);
        },
    };
}
