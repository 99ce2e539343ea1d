/* Which doors have not confirmed a change: asked again until all have, or until nobody looks any
 * more. */

import {_, _f} from '../base/i18n.js';
import {fill, h} from '../base/dom.js';
import {dateTime, number} from '../base/format.js';
import {badge} from './badge.js';
import {openDialog} from './dialog.js';

const EVERY_MS = 2000;

/* The doors of one zone as a list; a remark if there are none. */
export function unconfirmedList(doors) {
    if (!doors.length) {
        return badge('good', _('Confirmed by all doors'));
    }
    const line = (door) => door.online ? _('online') :
        door.reported_s                ? _f('offline, last report {time}', { time: dateTime(door.reported_s * 1000) }) :
                                         _('offline');
    return [
        badge('odd', _f('Not confirmed by doors: {n}', { n: number(doors.length) })),
        h('ul', { class: 'doors-waiting' },
          doors.map((door) => h('li', {}, h('bdi', {}, door.name), h('span', { class: 'quiet' }, ` ${line(door)}`))))
    ];
}

/* Shows the doors of these zones that have not confirmed, in a dialog. */
export function showWaiting(api, title, text, zones) {
    const ids = zones.map(({ id }) => id);
    let timer = 0;
    return openDialog(title, (close) => {
               const place = h('div', { role: 'status', 'aria-live': 'polite' });
               let open = true;
               const draw = (now) => fill(
                   place,
                   now.map(
                       (zone) =>
                           h('section', {}, h('h3', {}, h('bdi', {}, zone.name)), unconfirmedList(zone.unconfirmed))));
               const again = async () => {
                   try {
                       const now = (await api.lockdown()).filter(({ id }) => ids.includes(id));
                       draw(now);
                       open = open && now.some(({ unconfirmed }) => unconfirmed.length);
                   } catch {
                       /* the banner says that the hub does not answer */
                   }
                   if (open && place.isConnected) {
                       timer = setTimeout(again, EVERY_MS);
                   }
               };
               draw(zones);
               timer = setTimeout(again, EVERY_MS);
               return [
                   h('p', {}, text), place,
                   h('div', { class: 'buttons' },
                     h('button', { type: 'button', autofocus: true, onclick: () => close() }, _('Close')))
               ];
           }).finally(() => clearTimeout(timer));
}
