/* The week of a door: a row for each schedule that matters there, a column for each day. */

import {_, _f, languageTag, place} from '../base/i18n.js';
import {h, svg} from '../base/dom.js';
import {datesOfWeek, hoursOn, levelsAt, minutes, schedulesAt} from '../base/policy.js';
import {word} from '../base/words.js';
import {STATES} from '../base/words_policy.js';
import {stack} from '../view/stack.js';

const WIDTH = 96; /* of a day: a quarter of an hour is one unit */
const MIDDLE = [24, 48, 72];

/* The day of a date as the head of a column: "Mon 23". */
function dayName(date) {
    const format = new Intl.DateTimeFormat(
        languageTag() === 'ar' ? 'ar-u-nu-latn' : languageTag(), { weekday: 'short', day: 'numeric', timeZone: 'UTC' });
    return format.format(new Date(`${date}T12:00:00Z`));
}

/* A day as a bar from midnight to midnight. */
function bar(periods) {
    return svg(
        'svg', { viewBox: `0 0 ${WIDTH} 12`, class: 'day', 'aria-hidden': 'true', direction: 'ltr' },
        svg('rect', { class: 'ground', width: WIDTH, height: 12, rx: 2 }),
        periods.map(minutes).filter(Boolean).map(
            ([from, to]) => svg('rect', { class: 'open', x: from / 15, width: (to - from) / 15, height: 12, rx: 2 })),
        MIDDLE.map((x) => svg('line', { class: 'tick', x1: x, x2: x, y1: 0, y2: 12 })));
}

function dayCell(document, schedule, date, day, isToday) {
    const { periods, group } = hoursOn(document, schedule, date, day);
    return h(
        'td', { class: [isToday && 'today', group && 'special'].filter(Boolean).join(' ') }, bar(periods),
        h('span', { class: 'hours' },
          periods.length ? periods.map((one) => [h('bdi', { class: 'whole', dir: 'ltr' }, one), ' ']) : '–'),
        group && h('span', { class: 'mark' }, '★ ', h('bdi', {}, group)));
}

/* The state of a schedule in words, such as "card while nights is active". */
export function levelText(document, door) {
    const { level, others } = levelsAt(document, door);
    return [
        level,
        ...others.map(({ level: other, schedule, state }) => place(word(STATES, state), { level: other, schedule }))
    ].join('; ');
}

/* The week that has `today`, at one door. */
export function doorWeek(document, door, today = new Date()) {
    const dates = datesOfWeek(today);
    const now = (today.getDay() + 6) % 7;
    const rows = schedulesAt(document, door.token);
    const head = (text, attributes) => h('th', { scope: 'col', ...attributes }, text);
    const shown = _f('To be shown: {level}', { level: levelText(document, door) });
    const title = h('h3', {}, h('bdi', {}, door.token));
    if (!rows.length) {
        return h(
            'section', { class: 'door-week' }, title,
            h('p', { class: 'quiet' }, _('No access profile names this door, so nobody may enter here.')));
    }
    return h(
        'section', { class: 'door-week' }, title,
        door.enabled === false ? h('p', { class: 'fault' }, _('This door is out of service and lets nobody in.')) :
                                 h('p', { class: 'quiet' }, shown),
        h('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': door.token },
          stack(h(
              'table', { class: 'week' },
              h('thead', {},
                h('tr', {}, head(_('Schedule')),
                  dates.map(
                      (date, i) => head(dayName(date), i === now ? { class: 'today', 'aria-current': 'date' } : {})))),
              h('tbody', {},
                rows.map(
                    ({ schedule, profiles }) =>
                        h('tr', {},
                          h('th', { scope: 'row' }, h('bdi', {}, schedule.token),
                            h('span', { class: 'quiet' }, h('bdi', {}, profiles.join(', ')))),
                          dates.map((date, i) => dayCell(document, schedule, date, i, i === now)))))))));
}
