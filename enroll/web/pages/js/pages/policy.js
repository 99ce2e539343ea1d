/* The page Policy: who may enter where and when, and what the door would decide. */

import {N_, _, _f} from '../base/i18n.js';
import {fill, h} from '../base/dom.js';
import {example, textOf} from '../base/policy.js';
import {word} from '../base/words.js';
import {ANTIPASSBACK} from '../base/words_policy.js';
import {duration} from '../base/format.js';
import {faultText} from '../transport/fault.js';
import {badge} from '../view/badge.js';
import {confirm} from '../view/dialog.js';
import {download} from '../view/download.js';
import {chooseFile} from '../view/file.js';
import {notice, noticeFault} from '../view/notice.js';
import {stack} from '../view/stack.js';
import {editDates, editDocument, editHours} from './policy_edit.js';
import {question, whoMayEnter} from './policy_question.js';
import {doorWeek, levelText} from './policy_week.js';

const FILE_MOST_BYTES = 1 << 20;

function table(heads, rows) {
    return h(
        'div', { class: 'scroll' },
        stack(
            h('table', {}, h('thead', {}, h('tr', {}, heads.map((text) => h('th', { scope: 'col' }, text)))),
              h('tbody', {}, rows))));
}

const token = (text) => h('th', { scope: 'row' }, h('bdi', {}, text));
const code = (text) => h('code', {}, text);
const list = (parts) => parts.map((part, i) => [i > 0 && ', ', h('bdi', {}, part)]);

function panel(title, empty, records, make) {
    return h(
        'section', { class: 'panel' }, h('h2', {}, title),
        records.length ? make(records) : h('p', { class: 'quiet' }, empty));
}

const change = (name, onclick) =>
    h('button', { type: 'button', class: 'plain', 'aria-label': _f('Edit {name}', { name }), onclick }, _('Edit…'));

function schedules(document, store) {
    return panel(
        _('Schedules'), _('There is no schedule.'), document.schedules ?? [],
        (all) => table(
            [_('Schedule'), _('Time zone'), _('Hours of the week'), _('Special days'), _('Edit')],
            all.map(
                (one) =>
                    h('tr', {}, token(one.token), h('td', {}, code(one.zone)),
                      h('td', { dir: 'ltr' },
                        Object.entries(one.weekly ?? {})
                            .map(([days, hours]) => h('div', {}, code([days, hours.join(', ')].join(' '))))),
                      h('td', {},
                        (one.special_days ?? [])
                            .map(
                                ({ group, hours = [] }) =>
                                    h('div', {}, h('bdi', {}, group), ': ',
                                      hours.length ? code(hours.join(', ')) : _('no hours')))),
                      h('td', {}, change(one.token, () => editHours(document, one, store)))))));
}

function groups(document, store) {
    return panel(
        _('Special days'), _('There are no special days.'), document.special_day_groups ?? [],
        (all) => table(
            [_('Group'), _('Dates'), _('Edit')],
            all.map(
                (one) =>
                    h('tr', {}, token(one.token), h('td', {}, code(one.days.join(', '))),
                      h('td', {}, change(one.token, () => editDates(document, one, store)))))));
}

function antipassback({ antipassback: kind = 'none', antipassback_s: seconds }) {
    return [word(ANTIPASSBACK, kind), kind === 'timed' && [' (', duration(seconds * 1000), ')']];
}

function doorTable(document) {
    return panel(
        _('Doors'), _('There is no door.'), document.access_points ?? [],
        (all) => table(
            [_('Door'), _('Security level'), _('From'), _('To'), _('Antipassback')],
            all.map(
                (one) =>
                    h('tr', {}, token(one.token),
                      h('td', {},
                        one.enabled === false ? badge('bad', _('out of service')) :
                                                h('bdi', {}, levelText(document, one))),
                      h('td', {}, one.from ?? '–'), h('td', {}, one.to ?? '–'), h('td', {}, antipassback(one))))));
}

function profiles(document) {
    return panel(
        _('Access profiles'), _('There is no access profile.'), document.access_profiles ?? [],
        (all) => table(
            [_('Profile'), _('Doors and schedules')],
            all.map(
                (one) =>
                    h('tr', {},
                      h('th', { scope: 'row' }, h('bdi', {}, one.token),
                        one.token === document.default_profile &&
                            [' ', badge('plain', _('for people without a profile'))]),
                      h('td', {},
                        (one.policies ??
                         []).map(({ access_point, schedule }) => h('div', {}, list([access_point, schedule]))))))));
}

function findingList(findings, revision) {
    return h(
        'section', { class: 'panel' }, h('h2', {}, _('Check')),
        h('p', { class: 'quiet' }, _f('Revision {n} is in force.', { n: revision })),
        findings.length ?
            h('ul', { class: 'findings' },
              findings.map(
                  (one) => h('li', {}, badge('odd', _('Notice')), ' ', h('span', { lang: 'en', dir: 'ltr' }, one)))) :
            h('p', { class: 'good' }, _('The check found no schedule, person or door that can never let anybody in.')));
}

/* Reads a file and stores it. */
async function upload(store) {
    const file = await chooseFile('.json,application/json');
    if (!file) {
        return;
    }
    try {
        if (file.size > FILE_MOST_BYTES) {
            throw new Error(_('The file is too large.'));
        }
        let document;
        try {
            document = JSON.parse(await file.text());
        } catch (error) {
            throw new Error(_f('This is no JSON: {reason}', { reason: error.message }));
        }
        await store(document);
        notice(_('The policy is stored and in force.'));
        store.focus();
    } catch (error) {
        noticeFault(error);
    }
}

async function removePolicy(store) {
    const sure = await confirm(
        _('Remove the policy?'),
        _('Without a policy everybody who is enrolled is let in at any time, within their own limits. Cards and PINs of people stay.'),
        _('Remove the policy'), { danger: true });
    if (!sure) {
        return;
    }
    try {
        await store(null);
        notice(_('The policy is removed.'));
        store.focus();
    } catch (error) {
        noticeFault(error);
    }
}

function actions(document, store) {
    const button = (text, onclick, danger) =>
        h('button', { type: 'button', class: danger ? 'plain danger' : 'plain', onclick }, text);
    const save = () => download('isotherm-policy.json', [textOf(document), ''].join('\n'), 'application/json');
    return h(
        'div', { class: 'bar' }, button(_('Change as JSON…'), () => editDocument(document, store)),
        button(_('Upload a file…'), () => upload(store)), button(_('Download'), save),
        button(_('Remove the policy…'), () => removePolicy(store), true));
}

function empty(store) {
    const zone = Intl.DateTimeFormat().resolvedOptions().timeZone || 'UTC';
    return h(
        'section', { class: 'panel' }, h('h2', {}, _('There is no policy')),
        h('p', {}, _('Everybody who is enrolled is let in at any time, within their own limits.')),
        h('p', {},
          _('A policy says at which doors and at which hours people are let in, and what they have to show: a face, a card, a PIN, or a second person.')),
        h('div', { class: 'buttons start' },
          h('button', { type: 'button', onclick: () => editDocument(example(zone), store) },
            _('Begin with an example…')),
          h('button', { type: 'button', class: 'plain', onclick: () => upload(store) }, _('Upload a file…'))));
}

function make(context) {
    const { api } = context;
    const place = h('div', {}, h('p', { class: 'quiet' }, _('Loading…')));
    const state = { who: null, left: false, broken: false, pressed: '' };
    const label = (button) => button.getAttribute('aria-label') ?? button.textContent;

    function draw({ revision, document }, findings, people, store) {
        const doors = (document.access_points ?? []).map((one) => one.token);
        state.who = whoMayEnter(context, doors, people);
        fill(
            place, actions(document, store), findingList(findings, revision),
            h('section', { class: 'panel' }, h('h2', {}, _('This week')),
              (document.access_points ?? []).map((door) => doorWeek(document, door))),
            h('div', { class: 'columns questions' }, question(context, doors, people), state.who.element),
            schedules(document, store), groups(document, store), doorTable(document), profiles(document));
    }

    async function load() {
        try {
            const [policy, findings, { people }] = await Promise.all([api.policy(), api.findings(), api.people()]);
            const store = async (document) => {
                await api.storePolicy(policy.revision, document);
                await load();
            };
            store.focus = () => {
                const buttons = [...place.querySelectorAll('button')];
                (buttons.find((button) => label(button) === state.pressed) ?? buttons[0])?.focus();
            };
            state.who?.stop();
            state.who = null;
            state.broken = false;
            if (state.left) {
                return;
            }
            if (policy.document) {
                draw(policy, findings, people, store);
            } else {
                fill(place, empty(store));
            }
        } catch (error) {
            state.broken = true;
            fill(place, h('p', { class: 'fault', role: 'alert' }, faultText(error)));
        }
    }

    place.addEventListener('click', ({ target }) => {
        const button = target.closest('button');
        state.pressed = button ? label(button) : state.pressed;
    });
    load();
    /* What was typed into a question stays, unless there is nothing but a fault. */
    const end = context.hub.on('connection', (up) => up && state.broken && load());
    return {
        element: place,
        resume: () => state.broken && load(),
        leave() {
            state.left = true;
            state.who?.stop();
            end();
        },
    };
}

export const policy = {
    id: 'policy',
    title: N_('Policy'),
    least: 'administrator',
    make
};
