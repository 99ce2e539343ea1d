/* Tables that become a list on a phone: each cell stands below the one before, with its head before
 * it. The style sheet does this; the roles keep it a table for screen readers. */

function label(row, heads) {
    row.setAttribute('role', 'row');
    [...row.cells].forEach((cell, i) => {
        cell.setAttribute('role', cell.tagName === 'TH' ? 'rowheader' : 'cell');
        cell.dataset.label = heads[i] ?? '';
    });
    return row;
}

/* Makes a table with these heads such a table, and returns it. */
export function stack(table) {
    const heads = [...table.tHead.rows[0].cells].map((cell) => cell.textContent);
    table.classList.add('stack');
    table.setAttribute('role', 'table');
    for (const part of table.querySelectorAll('thead, tbody')) {
        part.setAttribute('role', 'rowgroup');
    }
    table.tHead.rows[0].setAttribute('role', 'row');
    for (const cell of table.tHead.rows[0].cells) {
        cell.setAttribute('role', 'columnheader');
    }
    const body = table.tBodies[0];
    [...body.rows].forEach((row) => label(row, heads));
    new MutationObserver((changes) => {
        for (const { addedNodes } of changes) {
            addedNodes.forEach((row) => row.cells && label(row, heads));
        }
    }).observe(body, { childList: true });
    return table;
}
