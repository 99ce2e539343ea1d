/* The questions about a policy: would a person be let in, and who may enter now. */

import {_, _f} from '../base/i18n.js';
import {fill, h, newId, say} from '../base/dom.js';
import {dateTime, fromLocalInput, number, toLocalInput} from '../base/format.js';
import {word} from '../base/words.js';
import {METHODS, REFUSALS} from '../base/words_policy.js';
import {faultText} from '../transport/fault.js';
import {badge} from '../view/badge.js';
import {form} from '../view/dialog.js';
import {checkbox, choice, field, input} from '../view/fields.js';

const NAMES_MOST = 500; /* that a field suggests; others can be typed */
const ASKED_MOST = 200;
const PAUSE_MS = 80; /* the door service answers 20 calls a second */
const ALL = Object.keys(METHODS);

/* An answer in words. */
function answerWords({ outcome, reason, wanted, companion, level }) {
    const holds = level ? _f('Security level: {level}', { level }) : '';
    if (outcome === 'allow') {
        return [badge('good', _('Would be let in')), holds];
    }
    if (outcome === 'want') {
        const more = [...wanted.map((one) => word(METHODS, one)), ...(companion ? [_('a second person')] : [])];
        return [badge('odd', _f('Wanted besides: {what}', { what: more.join(', ') })), holds];
    }
    return [badge('bad', _('Would be refused')), [word(REFUSALS, reason), holds].filter(Boolean).join('. ')];
}

/* "Would ... be let in at ... on ...?" */
export function question({api}, doors, people) {
    const names =
        h('datalist', { id: newId('people') },
          people.slice(0, NAMES_MOST).map(({ name }) => h('option', { value: name })));
    const person = input({ required: true, maxlength: 64, dir: 'auto', list: names.id });
    const door = choice([['', _('This door')], ...doors.map((token) => [token, token])], '', {});
    const time = input({ type: 'datetime-local', required: true, value: toLocalInput(Date.now() / 1000) });
    const shown = ALL.map((method) => [method, checkbox(word(METHODS, method), { checked: method === 'face' })]);
    const result = h('div', { role: 'status', class: 'answer' });
    const send = async () => {
        const time_s = fromLocalInput(time.value);
        const answer = await api.testAccess({
            person: person.value.trim(),
            access_point: door.value,
            time: time_s,
            shown: shown.filter(([, { box }]) => box.checked).map(([method]) => method)
        });
        return { answer, asked: _f('{name}, {time}:', { name: person.value.trim(), time: dateTime(time_s * 1000) }) };
    };
    const after = ({ answer, asked }) => {
        const [verdict, more] = answerWords(answer);
        fill(result, h('p', {}, h('bdi', {}, asked), ' ', verdict, more && [' ', h('span', { class: 'quiet' }, more)]));
    };
    return h(
        'section', { class: 'panel' }, h('h2', {}, _('Would this person be let in?')), names,
        form(
            [
                h('div', { class: 'pair' }, field(_('Person'), person), field(_('Door'), door), field(_('When'), time)),
                h('fieldset', { class: 'shown' }, h('legend', {}, _('What is shown')),
                  shown.map(([, { element }]) => element))
            ],
            _('Ask'), send, after),
        result);
}

/* Asks for each person; stops at the end, after an error, or when asked to. */
async function askAll(api, access_point, people, isStopped, each) {
    const time = Math.floor(Date.now() / 1000);
    for (const { name } of people) {
        if (isStopped()) {
            return;
        }
        try {
            each(name, await api.testAccess({ person: name, access_point, time, shown: ALL }));
        } catch (error) {
            if (error.code !== 'no-such-person') {
                throw error;
            }
        }
        await new Promise((resolve) => {
            setTimeout(resolve, PAUSE_MS);
        });
    }
}

/* Who may enter a door now, when face, card and PIN are right. */
export function whoMayEnter({api}, doors, people) {
    const door = choice([['', _('This door')], ...doors.map((token) => [token, token])], '', {});
    const list = h('ul', { class: 'names' });
    const status = h('p', { role: 'status', class: 'quiet' });
    const bar = h('progress', { max: 1, value: 0, 'aria-label': _('Progress'), hidden: true });
    const asked = people.slice(0, ASKED_MOST);
    let running = false;
    let stop = false;
    const begin = h('button', { type: 'button' }, _('Show who may enter now'));
    begin.addEventListener('click', async () => {
        if (running) {
            stop = true;
            return;
        }
        let [done, allowed] = [0, 0];
        running = true;
        stop = false;
        fill(list);
        Object.assign(bar, { max: asked.length || 1, value: 0, hidden: false });
        say(begin, _('Stop'));
        say(status, '');
        try {
            await askAll(api, door.value, asked, () => stop, (name, { outcome, companion }) => {
                done += 1;
                bar.value = done;
                if (outcome === 'allow' || (outcome === 'want' && companion)) {
                    allowed += 1;
                    list.append(
                        h('li', {}, h('bdi', {}, name),
                          outcome === 'want' && h('span', { class: 'quiet' }, ` (${_('with a second person')})`)));
                }
            });
            const counts = { n: number(allowed), asked: number(done), all: number(people.length) };
            say(status,
                done < people.length ? _f('May enter now: {n}. Only {asked} of {all} people were asked.', counts) :
                                       _f('May enter now: {n} of {all}', counts));
        } catch (error) {
            say(status, faultText(error));
        }
        running = false;
        bar.hidden = true;
        say(begin, _('Show who may enter now'));
    });
    return {
        element:
            h('section', { class: 'panel' }, h('h2', {}, _('Who may enter now?')),
              h('p', { class: 'quiet' },
                _('People whose face, card and PIN are right, by the policy and their own limits.')),
              h('div', { class: 'bar fields' }, field(_('Door'), door), begin), bar, status, list),
        stop() { stop = true; },
    };
}
