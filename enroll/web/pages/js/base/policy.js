/* What the pages read from a policy document (isotherm-policy(5)), and the changes that they make.
 * A change returns another document; what it does not concern stays as it is. Pure. */

/* The days as the document names them, Monday first. */
export const DAYS = ['monday', 'tuesday', 'wednesday', 'thursday', 'friday', 'saturday', 'sunday'];

const PERIOD = /^([01]\d|2[0-3]):([0-5]\d)-([01]\d|2[0-3]):([0-5]\d)$|^([01]\d|2[0-3]):([0-5]\d)-24:00$/;
const MOST_PERIODS = 8;
const MOST_DATES = 64;

/* The minutes of the day at which a period begins and ends, or null for what is no period. */
export function minutes(period) {
    const parts = PERIOD.exec(period);
    if (!parts) {
        return null;
    }
    const at = (hour, minute) => 60 * Number(hour) + Number(minute);
    const [from, to] =
        parts[1] === undefined ? [at(parts[5], parts[6]), 1440] : [at(parts[1], parts[2]), at(parts[3], parts[4])];
    return from < to ? [from, to] : null;
}

/* The indices of the days of a name such as "monday" or "saturday-monday". */
function daysOf(name) {
    const [first, last = first] = name.split('-').map((day) => DAYS.indexOf(day));
    if (first < 0 || last < 0) {
        return [];
    }
    return Array.from({ length: (last - first + 7) % 7 + 1 }, (_, i) => (first + i) % 7);
}

/* The periods of each day of the week, as texts: seven lists, Monday first. */
export function weekOf(schedule) {
    const week = DAYS.map(() => []);
    for (const [name, periods] of Object.entries(schedule.weekly ?? {})) {
        daysOf(name).forEach((day) => {
            week[day] = periods;
        });
    }
    return week;
}

/* The member `weekly` of seven lists: days in a row that are equal become one range. */
export function weeklyOf(week) {
    const weekly = {};
    for (let first = 0; first < 7;) {
        let last = first;
        while (last < 6 && week[last + 1].join() === week[first].join()) {
            last += 1;
        }
        if (week[first].length) {
            weekly[first === last ? DAYS[first] : `${DAYS[first]}-${DAYS[last]}`] = week[first];
        }
        first = last + 1;
    }
    return weekly;
}

/* The periods of a date "2026-12-25", which is the day `day` of the week, and the group of special
 * days that makes them; group is '' for the hours of the week. */
export function hoursOn(document, schedule, date, day) {
    const isOf = (group) =>
        (document.special_day_groups ?? []).find(({ token }) => token === group)?.days.includes(date);
    const special = (schedule.special_days ?? []).find(({ group }) => isOf(group));
    return special ? { periods: special.hours ?? [], group: special.group } :
                     { periods: weekOf(schedule)[day], group: '' };
}

/* The schedules that matter at a door, each with the access profiles that name it there. */
export function schedulesAt(document, door) {
    const found = new Map();
    for (const { token, policies = [] } of document.access_profiles ?? []) {
        for (const { access_point, schedule } of policies) {
            if (access_point === door) {
                found.set(schedule, [...(found.get(schedule) ?? []), token]);
            }
        }
    }
    return [...found].map(([token, profiles]) => {
        const schedule = (document.schedules ?? []).find((one) => one.token === token);
        return { schedule: schedule ?? { token, weekly: {} }, profiles };
    });
}

/* What has to be shown at a door: {level, others: [{level, schedule, state}]}. */
export function levelsAt(document, door) {
    const name = door.authentication_profile ?? 'face';
    const profile = (document.authentication_profiles ?? []).find(({ token }) => token === name);
    const others = (profile?.policies ?? [])
                       .flatMap(
                           ({ schedule, ...states }) =>
                               Object.entries(states)
                                   .filter(([, asked]) => asked?.level)
                                   .map(
                                       ([state, { level, two_people }]) =>
                                           ({ level, schedule, state, two_people: two_people === true })));
    return { level: profile?.default_level ?? 'face', others };
}

/* Reads "07:00-12:00, 13:00-19:00". Throws a SyntaxError with a word of POLICY_FLAWS. */
export function readPeriods(text) {
    const periods = text.split(/[\s,;]+/).filter(Boolean);
    let last = 0;
    for (const period of periods) {
        const at = minutes(period);
        if (!at) {
            throw new SyntaxError('period-wrong');
        }
        if (at[0] < last) {
            throw new SyntaxError('periods-overlap');
        }
        last = at[1];
    }
    if (periods.length > MOST_PERIODS) {
        throw new SyntaxError('too-many-periods');
    }
    return periods;
}

function isDate(text) {
    const date = /^\d{4}-\d\d-\d\d$/.test(text) ? new Date(`${text}T00:00:00Z`) : null;
    return date !== null && !Number.isNaN(date.getTime()) && date.toISOString().startsWith(text);
}

/* Reads dates, one after the other. Throws a SyntaxError with a word of POLICY_FLAWS. */
export function readDates(text) {
    const dates = [...new Set(text.split(/[\s,;]+/).filter(Boolean))];
    if (!dates.every(isDate)) {
        throw new SyntaxError('date-wrong');
    }
    if (dates.length > MOST_DATES) {
        throw new SyntaxError('too-many-dates');
    }
    return dates.sort();
}

const replace = (records, token, change) =>
    (records ?? []).map((one) => (one.token === token ? {...one, ...change } : one));

export function withHours(document, token, week) {
    return {...document, schedules: replace(document.schedules, token, { weekly: weeklyOf(week) }) };
}

export function withDates(document, token, days) {
    return {...document, special_day_groups: replace(document.special_day_groups, token, { days }) };
}

/* The document as people read and change it: JSON in lines, but a list of texts in one line. */
export function textOf(document) {
    const lists = /\[\s*"[^"\\]*"(?:,\s*"[^"\\]*")*\s*\]/g;
    return JSON.stringify(document, null, 2).replace(lists, (list) => `[${list.match(/"[^"\\]*"/g).join(', ')}]`);
}

/* A policy to begin with: one door, which opens to everybody who is enrolled in the hours of an office. */
export function example(zone) {
    return {
        special_day_groups: [
            { token: 'holidays', days: [`${new Date().getFullYear()}-12-25`, `${new Date().getFullYear() + 1}-01-01`] }
        ],
        schedules: [{
            token: 'office-hours',
            zone,
            weekly: { 'monday-friday': ['07:00-19:00'] },
            special_days: [{ group: 'holidays' }]
        }],
        access_points: [{ token: 'front' }],
        access_profiles: [{ token: 'staff', policies: [{ access_point: 'front', schedule: 'office-hours' }] }],
        default_profile: 'staff'
    };
}

/* The seven dates of the week of a day, Monday first, as the document writes them. The day is local. */
export function datesOfWeek(today) {
    const monday = today.getDate() - (today.getDay() + 6) % 7;
    const two = (n) => String(n).padStart(2, '0');
    return DAYS.map((_, i) => {
        const day = new Date(today.getFullYear(), today.getMonth(), monday + i);
        return `${day.getFullYear()}-${two(day.getMonth() + 1)}-${two(day.getDate())}`;
    });
}
