/* Lockdown and lock-out: their state, and for administrators the buttons that change it. The pages
 * Door and Settings show them. */

import {_} from '../base/i18n.js';
import {fill, h} from '../base/dom.js';
import {confirm} from '../view/dialog.js';
import {notice, noticeFault} from '../view/notice.js';

async function act(button, work, done) {
    button.disabled = true;
    try {
        await work();
        notice(done);
    } catch (error) {
        noticeFault(error);
    } finally {
        button.disabled = false;
    }
}

async function lockdown(api, button, on) {
    const sure = on ?
        await confirm(
            _('Begin lockdown?'), _('Nobody is let in until you end it. People can still leave.'), _('Begin lockdown'),
            { danger: true }) :
        await confirm(_('End lockdown?'), _('People who are enrolled are let in again.'), _('End lockdown'));
    if (sure) {
        await act(button, () => api.setLockdown(on), on ? _('Lockdown has begun.') : _('Lockdown has ended.'));
    }
}

async function lockout(api, button) {
    if (await confirm(
            _('End the lock-out?'), _('The attempts so far are forgotten, and people are let in again.'),
            _('End the lock-out'))) {
        await act(button, () => api.clearLockout(), _('The lock-out has ended.'));
    }
}

/* Buttons that fit the state; nothing for others than administrators. Returns {element, stop}. */
export function lockControls({api, hub, may}) {
    const element = h('div', { class: 'buttons start' });
    let drawn = '';
    const draw = () => {
        const on = hub.status.lockdown === true;
        const out = hub.status['lockout-ms'] > 0;
        const state = `${on} ${out} ${hub.daemon}`;
        if (!may('administrator') || hub.daemon !== true || state === drawn) {
            return;
        }
        drawn = state;
        fill(
            element,
            h('button',
              { type: 'button', class: on ? '' : 'danger', onclick: (event) => lockdown(api, event.target, !on) },
              on ? _('End lockdown…') : _('Begin lockdown…')),
            out &&
                h('button', { type: 'button', onclick: (event) => lockout(api, event.target) },
                  _('End the lock-out…')));
    };
    const stop = hub.on('changed', draw);
    draw();
    return { element, stop };
}
