/* A table of many rows: only those in sight are in the page. Two rows of empty height stand for the
 * others, so that the table stays a table for screen readers, with the number of all rows. */

import {h} from '../base/dom.js';

const MARGIN = 8; /* rows before and after those in sight */

/* `heads` are the cells of the head row. makeRow(item) returns a <tr>. Returns {element, set(items),
 * empty}; `element` scrolls by itself. */
export function virtualTable(label, heads, makeRow) {
    const before = h('tr', { 'aria-hidden': 'true', class: 'space' }, h('td', { colspan: heads.length }));
    const after = h('tr', { 'aria-hidden': 'true', class: 'space' }, h('td', { colspan: heads.length }));
    const body = h('tbody', {}, before, after);
    const table = h('table', { 'aria-label': label }, h('thead', {}, h('tr', { 'aria-rowindex': 1 }, heads)), body);
    const element = h('div', { class: 'rows', tabindex: 0, role: 'region', 'aria-label': label }, table);
    let items = [];
    let shown = new Map(); /* from the index of an item to its row */
    let height = 0;
    let due = false;

    function draw() {
        due = false;
        if (!height && items.length) {
            const probe = makeRow(items[0]);
            body.insertBefore(probe, after);
            height = probe.getBoundingClientRect().height;
            probe.remove();
        }
        const step = height || 44;
        const top = Math.max(0, element.scrollTop);
        const first = Math.max(0, Math.min(items.length, Math.floor(top / step)) - MARGIN);
        const last = Math.min(items.length, Math.ceil((top + element.clientHeight) / step) + MARGIN);
        const next = new Map();
        for (let i = first; i < last; i += 1) {
            const row = shown.get(i) ?? makeRow(items[i]);
            row.setAttribute('aria-rowindex', i + 2);
            next.set(i, row);
        }
        for (const [i, row] of shown) {
            if (!next.has(i)) {
                row.remove();
            }
        }
        let place = before;
        for (const row of next.values()) {
            if (place.nextSibling !== row) {
                body.insertBefore(row, place.nextSibling);
            }
            place = row;
        }
        shown = next;
        before.firstChild.style.height = `${first * step}px`;
        after.firstChild.style.height = `${Math.max(0, items.length - last) * step}px`;
    }

    function plan() {
        if (!due) {
            due = true;
            requestAnimationFrame(draw);
        }
    }

    element.addEventListener('scroll', plan, { passive: true });
    new ResizeObserver(() => {
        height = 0; /* the layout of a row depends on the width */
        plan();
    }).observe(element);
    return {
        element,
        set(all) {
            items = all;
            table.setAttribute('aria-rowcount', items.length + 1);
            shown.forEach((row) => row.remove());
            shown = new Map();
            plan();
        },
    };
}
