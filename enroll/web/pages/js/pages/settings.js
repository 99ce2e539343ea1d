/* The page Settings: lockdown and lock-out, and the values with which the daemon runs, some of which
 * can be changed. */

import {N_, _, _f} from '../base/i18n.js';
import {fill, h, say} from '../base/dom.js';
import {duration, number} from '../base/format.js';
import {fold, matcher} from '../base/fold.js';
import {faultText} from '../transport/fault.js';
import {badge} from '../view/badge.js';
import {input} from '../view/fields.js';
import {stack} from '../view/stack.js';
import {lockControls} from './lock_controls.js';
import {changeSetting} from './setting.js';

function lockState({ hub }) {
    const list = h('dl', { class: 'facts' });
    const row = (name, value) => [h('dt', {}, name), h('dd', {}, value)];
    const draw = () => fill(
        list, row(_('Lockdown'), hub.status.lockdown ? badge('bad', _('On')) : _('Off')),
        row(_('Lock-out'),
            hub.status['lockout-ms'] > 0 ?
                badge('bad', _f('On, for another {time}', { time: duration(hub.status['lockout-ms']) })) :
                _('Off')));
    const stop = hub.on('changed', draw);
    draw();
    return { element: list, stop };
}

const shown = (text) => h('code', {}, text === '' ? '–' : text);

function valueCell(one, change) {
    const name = `${one.section}.${one.key}`;
    return h(
        'td', {}, shown(one.value), one.value !== one.default && h('span', { class: 'unseen' }, ` ${_('changed')}`),
        one.changeable &&
            h('div', {},
              h('button', {
                  type: 'button',
                  class: 'plain',
                  'aria-label': _f('Change {name}', { name }),
                  onclick: () => change(one)
              },
                _('Change…'))));
}

function sectionTable(section, list, change) {
    const head = (text) => h('th', { scope: 'col' }, text);
    const row = (one) =>
        h('tr', { class: one.value === one.default ? '' : 'own' }, h('th', { scope: 'row' }, h('code', {}, one.key)),
          valueCell(one, change), h('td', {}, shown(one.configured ?? one.value)), h('td', {}, shown(one.default)),
          h('td', { lang: 'en', dir: 'ltr' }, one.range), h('td', { lang: 'en', dir: 'ltr' }, one.help));
    return h(
        'section', { class: 'panel' }, h('h3', { dir: 'ltr' }, h('code', {}, `[${section}]`)),
        h('div', { class: 'scroll' },
          stack(
              h('table', { class: 'settings' },
                h('thead', {},
                  h('tr', {}, head(_('Setting')), head(_('Value')), head(_('In the file')), head(_('Default')),
                    head(_('Allowed')), head(_('Meaning')))),
                h('tbody', {}, list.map(row))))));
}

function make(context) {
    const { api } = context;
    const state = lockState(context);
    const controls = lockControls(context);
    const place = h('div', {});
    const count = h('p', { class: 'quiet', role: 'status' });
    const search = input({ type: 'search', placeholder: _('Search settings'), 'aria-label': _('Search settings') });
    let all = [];
    const draw = () => {
        const takes = matcher(search.value);
        const found = all.filter((one) => takes(fold(`${one.section} ${one.key} ${one.help}`)));
        const sections = [...new Set(found.map((one) => one.section))];
        const tableOf = (section) => sectionTable(section, found.filter((one) => one.section === section), change);
        fill(place, sections.map(tableOf));
        say(count, _f('Settings: {n}', { n: number(found.length) }));
    };
    const change = async (one) => {
        if (await changeSetting(api, one)) {
            await load();
            const label = _f('Change {name}', { name: `${one.section}.${one.key}` });
            [...place.querySelectorAll('button')].find((button) => button.ariaLabel === label)?.focus();
        }
    };
    search.addEventListener('input', draw);
    const load = async () => {
        try {
            all = await api.settings();
            draw();
        } catch (error) {
            fill(place, h('p', { class: 'fault', role: 'alert' }, faultText(error)));
        }
    };
    if (api.can.settings) {
        load();
    }
    return {
        element: h(
            'div', {},
            h('section', { class: 'panel' }, h('h2', {}, _('Lockdown and lock-out')), state.element, controls.element),
            h('section', {}, h('h2', {}, _('Settings of the door service')),
              h('p', { class: 'quiet' },
                _('They are in the file /etc/isotherm/isotherm.conf on the appliance. Those with a button can be changed here and hold at once; the others hold from its next start on. Values that differ from the default are bold.')),
              api.can.settings && [h('div', { class: 'bar' }, search), count, place])),
        resume: load,
        leave() {
            state.stop();
            controls.stop();
        },
    };
}

export const settings = {
    id: 'settings',
    title: N_('Settings'),
    least: 'administrator',
    make
};
