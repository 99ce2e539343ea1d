/* A file that the user chooses. */

import {h} from '../base/dom.js';

/* `kinds` as the attribute accept has them. Resolves to the file, or undefined. */
export function chooseFile(kinds) {
    return new Promise((resolve) => {
        const file = h('input', { type: 'file', accept: kinds, hidden: true });
        file.addEventListener('change', () => resolve(file.files[0]));
        file.addEventListener('cancel', () => resolve(undefined));
        document.body.append(file);
        file.click();
        file.remove();
    });
}
