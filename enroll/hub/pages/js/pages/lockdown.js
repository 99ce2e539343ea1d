/* The page Lockdown: which zones let nobody in, and which doors have not confirmed it. */

import {N_, _, _f} from '../base/i18n.js';
import {fill, h} from '../base/dom.js';
import {faultText} from '../transport/fault.js';
import {badge} from '../view/badge.js';
import {confirm} from '../view/dialog.js';
import {notice, noticeFault} from '../view/notice.js';
import {stack} from '../view/stack.js';
import {unconfirmedList} from '../view/waiting.js';

const EVERY_MS = 2000; /* while a door has not confirmed */

function ask(on, name) {
    if (on) {
        return confirm(
            name ? _f('Begin lockdown of {name}?', { name }) : _('Begin lockdown of all zones?'),
            _('Nobody is let in until you end it. People can still leave.'), _('Begin lockdown'), { danger: true });
    }
    return confirm(
        name ? _f('End lockdown of {name}?', { name }) : _('End lockdown of all zones?'),
        _('People who are enrolled are let in again.'), _('End lockdown'));
}

function make({ api, hub, may }) {
    const admin = may('administrator');
    const body = h('tbody', {});
    const fault = h('p', { class: 'fault', role: 'alert' });
    const all = h('div', { class: 'buttons start' });
    let drawn = '';
    let timer = 0;
    let open = true;

    const change = (on, zone) => async () => {
        try {
            if (await ask(on, zone?.name)) {
                draw(await api.setLockdown(on, zone?.id));
                notice(on ? _('Lockdown has begun.') : _('Lockdown has ended.'));
            }
        } catch (error) {
            noticeFault(error);
        }
        hub.ask();
    };

    function row(zone) {
        const text = zone.lockdown ? _('End lockdown…') : _('Begin lockdown…');
        return h(
            'tr', {}, h('th', { scope: 'row' }, h('bdi', {}, zone.name)),
            h('td', {}, zone.lockdown ? badge('bad', _('Lockdown')) : badge('good', _('Normal'))),
            h('td', {}, h('div', {}, unconfirmedList(zone.unconfirmed))),
            admin &&
                h('td', {},
                  h('button', {
                      type: 'button',
                      class: zone.lockdown ? '' : 'plain danger',
                      'aria-label': `${text} ${zone.name}`,
                      onclick: change(!zone.lockdown, zone)
                  },
                    text)));
    }

    function draw(zones) {
        const text = JSON.stringify(zones);
        if (text !== drawn) {
            drawn = text;
            fill(body, zones.map(row));
            fill(
                all,
                admin && zones.some(({ lockdown }) => !lockdown) &&
                    h('button', { type: 'button', class: 'danger', onclick: change(true) },
                      _('Begin lockdown of all zones…')),
                admin && zones.some(({ lockdown }) => lockdown) &&
                    h('button', { type: 'button', onclick: change(false) }, _('End lockdown of all zones…')));
        }
    }

    async function load() {
        clearTimeout(timer);
        try {
            const zones = await api.lockdown();
            if (!open) {
                return;
            }
            draw(zones);
            fill(fault);
            if (zones.some(({ unconfirmed }) => unconfirmed.length)) {
                timer = setTimeout(load, EVERY_MS);
            }
        } catch (error) {
            fill(fault, faultText(error));
        }
    }

    const end = hub.on('tick', load);
    load();
    const head = (text) => h('th', { scope: 'col' }, text);
    return {
        element:
            h('div', {},
              h('p', { class: 'quiet' },
                _('A door that has not confirmed does not have the change, or has not said so.')),
              all, fault,
              h('div', { class: 'panel scroll', tabindex: 0, role: 'region', 'aria-label': _('Lockdown') },
                stack(
                    h('table', {}, h('caption', { class: 'unseen' }, _('Lockdown')),
                      h('thead', {},
                        h('tr', {}, head(_('Zone')), head(_('State')), head(_('Confirmation')),
                          admin && head(_('Change')))),
                      body)))),
        resume: load,
        leave() {
            open = false;
            clearTimeout(timer);
            end();
        },
    };
}

export const lockdown = {
    id: 'lockdown',
    title: N_('Lockdown'),
    least: 'observer',
    make
};
