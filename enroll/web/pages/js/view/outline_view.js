/* Draws what is before the camera: the silhouette, and the outline of the face. */

import {COLUMNS, ROWS, isSet} from '../stream/record.js';
import {h} from '../base/dom.js';

const SCALE = 8;

function polygon(context, points) {
    context.beginPath();
    points.forEach(([x, y], i) => {
        /* Rounded corners: from the middle of one side to the middle of the next. */
        const [nextX, nextY] = points[(i + 1) % points.length];
        const middle = [(x + nextX) / 2 * SCALE, (y + nextY) / 2 * SCALE];
        if (i === 0) {
            const [lastX, lastY] = points.at(-1);
            context.moveTo((x + lastX) / 2 * SCALE, (y + lastY) / 2 * SCALE);
        }
        context.quadraticCurveTo(x * SCALE, y * SCALE, ...middle);
    });
    context.closePath();
}

/* A canvas, and draw(record) for it; draw(null) shows nothing. `label` says what it is. */
export function outlineView(label) {
    const canvas = h('canvas', { width: COLUMNS * SCALE, height: ROWS * SCALE, role: 'img', 'aria-label': label });
    const context = canvas.getContext('2d');
    return {
        element: canvas,
        draw(record) {
            const style = getComputedStyle(canvas);
            const colour = (name) => style.getPropertyValue(name).trim();
            context.fillStyle = colour('--scene');
            context.fillRect(0, 0, canvas.width, canvas.height);
            if (!record) {
                return;
            }
            context.fillStyle = colour('--shape');
            for (let row = 0; row < ROWS; row += 1) {
                for (let column = 0; column < COLUMNS; column += 1) {
                    if (isSet(record.silhouette, column, row)) {
                        context.fillRect(column * SCALE, row * SCALE, SCALE, SCALE);
                    }
                }
            }
            if (record.outline.length > 2) {
                const kind = { allow: '--face-good', deny: '--face-bad' }[record.verdict] ?? '--face';
                polygon(context, record.outline);
                context.lineJoin = 'round';
                context.lineWidth = 10;
                context.strokeStyle = colour('--scene');
                context.stroke();
                context.lineWidth = 5;
                context.strokeStyle = colour(kind);
                context.stroke();
            }
        },
    };
}
