/* What every page of the hub says at its top when something is out of the ordinary. */

import {_, _f} from '../base/i18n.js';
import {fill, h} from '../base/dom.js';
import {number} from '../base/format.js';

function lines({ hub, may }) {
    const { status } = hub;
    if (hub.connected === false) {
        return [['bad', _('Connection lost, trying again…')]];
    }
    if (!status) {
        return [];
    }
    const link = (page, text) => h('a', { href: `#${page}` }, text);
    return [
        status.zones.lockdown > 0 &&
            ['bad', link('lockdown', _f('Zones in lockdown: {n}', { n: number(status.zones.lockdown) }))],
        status.zones.behind > 0 &&
            [
                'bad',
                link('overview', _f('Zones that know less than their doors: {n}', { n: number(status.zones.behind) }))
            ],
        status.requests > 0 && may('enroller') &&
            ['odd', link('requests', _f('Requests that wait: {n}', { n: number(status.requests) }))],
    ].filter(Boolean);
}

export function fleetBanner(context) {
    const place = h('div', { class: 'banner', role: 'status', 'aria-live': 'polite' });
    let said = '';
    const draw = () => {
        const shown = lines(context);
        const text = shown.map(([, line]) => line.textContent ?? line).join('\n');
        if (text !== said) {
            said = text;
            fill(place, shown.map(([kind, line]) => h('p', { class: kind }, line)));
        }
    };
    context.hub.on('changed', draw);
    draw();
    return place;
}
