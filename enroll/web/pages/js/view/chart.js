/* A line or bars over time, as SVG, with a table of the same values for those who do not see it. */

import {h, newId, svg} from '../base/dom.js';
import {_} from '../base/i18n.js';
import {number, shortTime} from '../base/format.js';

const WIDTH = 720;
const HEIGHT = 150;
const LEFT = 44;
const BOTTOM = 22;

/* A round number at or above a value: 1, 2 or 5 times a power of ten. */
export function roundUp(value) {
    if (!(value > 0)) {
        return 1;
    }
    const power = 10 ** Math.floor(Math.log10(value));
    return [1, 2, 5, 10].map((n) => n * power).find((n) => n >= value * 0.9999);
}

/* Pieces of a line: a gap of more than three minutes, or a value that is none, breaks it. */
export function pieces(points) {
    const out = [];
    let last = null;
    for (const point of points) {
        if (!Number.isFinite(point.value)) {
            last = null;
            continue;
        }
        if (!last || point.time - last.time > 180) {
            out.push([]);
        }
        out.at(-1).push(point);
        last = point;
    }
    return out;
}

/* Means or sums of equal spans, so that the table stays short. */
function spans(points, total) {
    const groups = new Map();
    for (const { time, value } of points) {
        if (Number.isFinite(value)) {
            const begin = Math.floor(time / 3600) * 3600;
            groups.set(begin, [...(groups.get(begin) ?? []), value]);
        }
    }
    return [...groups].map(([begin, values]) => {
        const sum = values.reduce((a, b) => a + b, 0);
        return [begin, total ? sum : sum / values.length];
    });
}

/* points: [{time (s), value}], the oldest first. `total`: the values of an hour add up, and are drawn
 * as bars. */
export function chart(title, points, {digits = 0, total = false} = {}) {
    const hours = spans(points, total);
    const values = (total ? hours.map(([, value]) => value) : points.map(({ value }) => value)).filter(Number.isFinite);
    if (!values.length) {
        return h(
            'figure', { class: 'chart' }, h('figcaption', {}, title), h('p', { class: 'quiet' }, _('No values yet.')));
    }
    const top = roundUp(Math.max(...values));
    const [first, last] = [points[0].time, Math.max(points.at(-1).time, points[0].time + 60)];
    const x = (time) => LEFT + (time - first) / (last - first) * (WIDTH - LEFT - 8);
    const y = (value) => HEIGHT - BOTTOM - value / top * (HEIGHT - BOTTOM - 10);
    const line = (piece) =>
        piece.map(({ time, value }, i) => `${i ? 'L' : 'M'}${x(time).toFixed(1)} ${y(value).toFixed(1)}`).join('') +
        (piece.length === 1 ? 'h1' : '');
    const label = (value) =>
        [svg('line', { class: 'grid', x1: LEFT, x2: WIDTH - 8, y1: y(value), y2: y(value) }),
         svg('text', { x: LEFT - 6, y: y(value) + 4, 'text-anchor': 'end' },
             number(value, Number.isInteger(value) ? 0 : 1))];
    const drawn = total ?
        hours.map(([begin, value]) => svg('rect', {
                      class: 'column',
                      x: Math.max(LEFT, x(begin)),
                      y: y(value),
                      width: Math.max(1, x(Math.min(last, begin + 3600)) - Math.max(LEFT, x(begin)) - 2),
                      height: y(0) - y(value)
                  })) :
        svg('path', { class: 'curve', d: pieces(points).map(line).join('') });
    const id = newId('chart');
    return h(
        'figure', { class: 'chart' }, h('figcaption', { id }, title),
        svg('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: 'img', 'aria-labelledby': id, direction: 'ltr' },
            label(0), label(top / 2), label(top), svg('text', { x: LEFT, y: HEIGHT - 4 }, shortTime(first * 1000)),
            svg('text', { x: WIDTH - 8, y: HEIGHT - 4, 'text-anchor': 'end' }, shortTime(last * 1000)), drawn),
        h('details', {}, h('summary', {}, _('As a table')),
          h('table', {},
            h('thead', {}, h('tr', {}, h('th', { scope: 'col' }, _('Hour')), h('th', { scope: 'col' }, title))),
            h('tbody', {},
              hours.map(
                  ([begin, value]) =>
                      h('tr', {}, h('th', { scope: 'row' }, shortTime(begin * 1000)),
                        h('td', {}, number(value, digits))))))));
}
