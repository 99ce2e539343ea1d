/* What every page says at its top when something is out of the ordinary: no connection, no daemon,
 * lockdown, lock-out, an enrolment that goes on. */

import {_, _f} from '../base/i18n.js';
import {fill, h} from '../base/dom.js';
import {duration} from '../base/format.js';

function lines(hub) {
    const { status } = hub;
    if (hub.connected === false) {
        return [['bad', _('Connection lost, trying again…')]];
    }
    if (hub.daemon === false) {
        return [['bad', _('The door service does not run. Trying again…')]];
    }
    return [
        status.lockdown === true && ['bad', _('Lockdown: nobody is let in.')],
        status['lockout-ms'] > 0 &&
            [
                'bad',
                _f('Locked out after too many attempts, for another {time}.', { time: duration(status['lockout-ms']) })
            ],
        status['storage-fault'] && ['bad', _('The disk reports errors: see Health.')],
        hub.enrolment?.state === 'running' && hub.enrolment.own && location.hash.split('?')[0] !== '#enrol' &&
            [
                'odd',
                h('a', { href: '#enrol' }, _f('The enrolment of {name} goes on.', { name: hub.enrolment.person ?? '' }))
            ],
    ].filter(Boolean);
}

export function banner({hub}) {
    const place = h('div', { class: 'banner', role: 'status', 'aria-live': 'polite' });
    let said = '';
    const draw = () => {
        const shown = lines(hub);
        const text = shown.map(([, line]) => line.textContent ?? line).join('\n');
        if (text !== said) {
            said = text;
            fill(place, shown.map(([kind, line]) => h('p', { class: kind }, line)));
        }
    };
    hub.on('changed', draw);
    addEventListener('hashchange', draw);
    draw();
    return place;
}
