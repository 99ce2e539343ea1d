/* A choice of several zones. */

import {_} from '../base/i18n.js';
import {h} from '../base/dom.js';
import {checkbox} from './fields.js';

/* `zones` is the list of all zones, `chosen` the ids that are chosen at the beginning. read() returns
 * the ids that are chosen now: first those of `chosen`, in their order, then the others. If no zone
 * is chosen, it throws an Error whose message is a sentence for people. */
export function zoneChoice(zones, chosen = [], label = _('Zones')) {
    const boxes = zones.map(({ id, name }) => {
        const { box, element } = checkbox(h('bdi', {}, name), { checked: chosen.includes(id) });
        return { id, box, element };
    });
    return {
        element:
            h('fieldset', {}, h('legend', {}, label),
              boxes.length ? boxes.map(({ element }) => element) :
                             h('p', { class: 'quiet' }, _('There is no zone yet.'))),
        read() {
            const now = boxes.filter(({ box }) => box.checked).map(({ id }) => id);
            if (!now.length) {
                throw new Error(_('Choose at least one zone.'));
            }
            return [...chosen.filter((id) => now.includes(id)), ...now.filter((id) => !chosen.includes(id))];
        },
    };
}
