/* A drawn head with an arrow: how to hold the head in a step of the enrolment. Left and right are
 * the subject's; the picture is a mirror, as the subject sees it. */

import {svg} from '../base/dom.js';

/* How far nose and eyes move from the middle, and where the arrow goes: from, to. */
const POSES = {
    frontal: { x: 0, y: 0 },
    left: { x: -11, y: 0, arrow: 'M38 12 Q24 8 12 20 M12 20 l1 -9 M12 20 l9 -2' },
    right: { x: 11, y: 0, arrow: 'M62 12 Q76 8 88 20 M88 20 l-1 -9 M88 20 l-9 -2' },
    down: { x: 0, y: 9, arrow: 'M92 38 L92 66 M92 66 l-6 -7 M92 66 l6 -7' },
    up: { x: 0, y: -9, arrow: 'M92 66 L92 38 M92 38 l-6 7 M92 38 l6 7' },
};

/* A picture for a pose; one without a name in words beside it needs `label`. */
export function headPicture(pose, label) {
    const { x, y, arrow } = POSES[pose] ?? POSES.frontal;
    const at = (cx, cy) => ({ cx: cx + x, cy: cy + y });
    return svg(
        'svg', {
            viewBox: '0 0 100 100',
            class: 'head',
            role: label ? 'img' : undefined,
            'aria-label': label,
            'aria-hidden': label ? undefined : 'true'
        },
        svg('path', {
            class: 'skin',
            d: 'M50 16 C72 16 78 34 76 52 C74 72 62 88 50 88 C38 88 26 72 24 52 C22 34 28 16 50 16 Z'
        }),
        svg('circle', { class: 'mark', r: 3.4, ...at(40, 46) }),
        svg('circle', { class: 'mark', r: 3.4, ...at(60, 46) }), svg('path', {
            class: 'line',
            d: `M${50 + x} ${48 + y} L${50 + 1.35 * x} ${60 + 1.2 * y} L${46 + 1.2 * x} ${61 + 1.1 * y}`
        }),
        svg('path',
            { class: 'line', d: `M${42 + x} ${72 + 0.8 * y} Q${50 + x} ${75 + 0.8 * y} ${58 + x} ${72 + 0.8 * y}` }),
        arrow && svg('path', { class: 'arrow', d: arrow }));
}
