/* How an appliance joins: the one-time address as a QR code and as text, and the form for a new
 * door. */

import {_, _f} from '../base/i18n.js';
import {h} from '../base/dom.js';
import {dateTime} from '../base/format.js';
import {form, openDialog} from '../view/dialog.js';
import {field, input} from '../view/fields.js';
import {notice} from '../view/notice.js';
import {zoneChoice} from '../view/zone_choice.js';

/* The picture comes from the hub; as an image it can run no script. */
function picture(text) {
    return h(
        'img',
        { class: 'qr', alt: _('The join address as a QR code'), src: `data:image/svg+xml;base64,${btoa(text)}` });
}

/* Shows the address of an answer to addDoor or newCode. */
export function showJoin({name, join}) {
    const copy = async () => {
        await navigator.clipboard?.writeText(join.address);
        notice(_('Copied.'));
    };
    return openDialog(
        _f('{name} may join now', { name }),
        (close) =>
            [h('p', {}, _('Type this on the appliance; a phone reads it from the code. It works once, and is not shown again.')),
             picture(join.qr_svg),
             h('p', {}, h('code', { class: 'long' }, `sudo isotherm-link join '${join.address}'`)),
             h('p', { class: 'quiet' }, _f('It holds until {time}.', { time: dateTime(join.until_s * 1000) })),
             h('div', { class: 'buttons' },
               h('button', { type: 'button', class: 'plain', onclick: copy }, _('Copy the address')),
               h('button', { type: 'button', autofocus: true, onclick: () => close() }, _('Close')))]);
}

export async function addDoor({api}, zones, changed) {
    const name = input({ required: true, maxlength: 64, dir: 'auto' });
    const picked = zoneChoice(zones, zones.length === 1 ? [zones[0].id] : []);
    let added = null;
    await openDialog(_('Add a door'), (close) => form([field(_('Name'), name), picked.element], _('Add'), async () => {
                                          added = await api.addDoor(name.value.trim(), picked.read());
                                      }, () => close(true), { cancel: () => close() }));
    if (added) {
        changed();
        await showJoin(added);
        changed();
    }
}
