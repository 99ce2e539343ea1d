/* The page People: who is enrolled, and until when. */

import {N_, _, _f, languageTag} from '../base/i18n.js';
import {fill, h, say} from '../base/dom.js';
import {dateTime, limit, number} from '../base/format.js';
import {fold, matcher} from '../base/fold.js';
import {peopleToCsv} from '../base/people_csv.js';
import {faultText} from '../transport/fault.js';
import {badge} from '../view/badge.js';
import {datedName, download} from '../view/download.js';
import {choice, input} from '../view/fields.js';
import {virtualTable} from '../view/rows.js';
import {importPeople} from './people_import.js';
import {openPerson} from './person.js';

const ORDERS = {
    name: N_('Name'),
    enrolled: N_('Enrolled, newest first'),
    seen: N_('Last seen, newest first'),
    until: N_('Valid until, soonest first'),
};

function comparison(order) {
    const { compare } = new Intl.Collator(languageTag(), { numeric: true });
    return {
        name: (a, b) => compare(a.name, b.name),
        enrolled: (a, b) => b.enrolled_s - a.enrolled_s,
        seen: (a, b) => (b.last_seen_s ?? 0) - (a.last_seen_s ?? 0),
        until: (a, b) => (a.valid_until_s || Infinity) - (b.valid_until_s || Infinity) || compare(a.name, b.name),
    }[order];
}

/* Whether a person may come in now: "now", "later" or "ended". */
export function validity(person, nowS = Date.now() / 1000) {
    if (person.valid_until_s && person.valid_until_s <= nowS) {
        return 'ended';
    }
    return person.valid_from_s > nowS ? 'later' : 'now';
}

const SHORT = {
    now: (person) => (person.valid_until_s ? _f('until {time}', { time: limit(person.valid_until_s) }) : _('no limit')),
    later: (person) => _f('from {time}', { time: limit(person.valid_from_s) }),
    ended: (person) => _f('ended {time}', { time: limit(person.valid_until_s) }),
};

function makeRow(person, open) {
    const state = validity(person);
    return h(
        'tr', { class: state === 'now' ? '' : 'resting' },
        h('th', { scope: 'row' },
          h('button', { type: 'button', class: 'link', onclick: () => open(person) }, h('bdi', {}, person.name)),
          h('span', { class: 'narrow' }, SHORT[state](person), person.enabled === false && [' · ', _('suspended')])),
        h('td', {}, limit(person.valid_from_s)),
        h('td', {}, limit(person.valid_until_s),
          state === 'ended' && h('span', { class: 'sign', title: _('ended') }, ' ⏱')),
        h('td', { class: 'number' }, person.templates), h('td', {}, dateTime(person.enrolled_s * 1000)),
        h('td', {}, person.last_seen_s ? dateTime(person.last_seen_s * 1000) : '–'),
        person.cards &&
            h('td', { title: person.cards.join(' ') || false }, h('bdi', {}, person.cards.join(' ') || '–'),
              !person.enabled && [' ', badge('bad', _('suspended'))]));
}

/* Only administrators see cards. */
function heads(withCards) {
    return [
        _('Name'), _('Valid from'), _('Valid until'), _('Templates'), _('Enrolled'), _('Last seen'),
        ...(withCards ? [_('Cards')] : [])
    ]
        .map(
            (text, i) =>
                h('th', { scope: 'col',
                          class: i === 3           ? 'number' :
                              i === 0 && withCards ? 'short' :
                                                     '' },
                  text));
}

function make(context) {
    const { api, may } = context;
    const state = { all: [], shown: [], order: 'name', query: '' };
    const table = virtualTable(
        _('People'), heads(may('administrator')), (person) => makeRow(person, (one) => openPerson(context, one, load)));
    const count = h('p', { class: 'quiet', role: 'status' }, _('Loading…'));
    const what = may('administrator') ? _('Search by name or card') : _('Search by name');
    const search = input({ type: 'search', placeholder: what, 'aria-label': what, spellcheck: 'false' });
    const order =
        choice(Object.entries(ORDERS).map(([key, text]) => [key, _(text)]), 'name', { 'aria-label': _('Sort by') });
    const remark = h('p', { class: 'fault', role: 'alert' });

    function filter() {
        const takes = matcher(search.value);
        state.shown = state.all.filter((person) => takes(person.folded));
        table.set(state.shown);
        say(count,
            search.value.trim() ?
                _f('{shown} of {all} people', { shown: number(state.shown.length), all: number(state.all.length) }) :
                _f('People: {all}', { all: number(state.all.length) }));
    }

    function sort() {
        state.all.sort(comparison(order.value));
        table.element.scrollTop = 0;
        filter();
    }

    async function load() {
        try {
            const { people = [], log_read } = await api.people();
            state.all =
                people.map((person) => ({...person, folded: fold([person.name, ...(person.cards ?? [])].join(' ')) }));
            fill(remark, log_read === false ? _('The log is still being read: "Last seen" may be missing.') : '');
            sort();
        } catch (error) {
            fill(remark, faultText(error));
        }
    }

    const timers = { search: 0, load: 0 };
    search.addEventListener('input', () => {
        clearTimeout(timers.search);
        timers.search = setTimeout(filter, 80);
    });
    order.addEventListener('change', sort);
    load();
    const end = context.hub.on('connection', (up) => up && load());
    return {
        element: h(
            'div', { class: 'list' },
            h('div', { class: 'bar' }, search, order, h('a', { class: 'button', href: '#enrol' }, _('Enrol a person')),
              h('button', {
                  type: 'button',
                  class: 'plain',
                  onclick: () => download(datedName('people'), peopleToCsv(state.shown))
              },
                _('Export CSV')),
              may('administrator') &&
                  h('button', { type: 'button', class: 'plain', onclick: () => importPeople(api, state.all, load) },
                    _('Import CSV…'))),
            remark, count, table.element),
        resume: load,
        leave() {
            clearTimeout(timers.search);
            end();
        },
    };
}

export const people = {
    id: 'people',
    title: N_('People'),
    least: 'enroller',
    make
};
