/* What the pages read from a policy document, and how they change it. */

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load, read } from './sources.mjs';

const policy = await load('base/policy.js');
const office = JSON.parse(read('enroll/examples/policy-office.json'));
const [staff, visiting, nights] = office.schedules;

test('a period is read as minutes of the day', () => {
    assert.deepEqual(policy.minutes('09:00-17:30'), [540, 1050]);
    assert.deepEqual(policy.minutes('22:00-24:00'), [1320, 1440]);
    for (const wrong of ['9:00-17:30', '17:30-09:00', '09:00-09:00', '24:00-24:00', '09:60-10:00', '23:00-24:01', '09:00 - 10:00', '']) {
        assert.equal(policy.minutes(wrong), null, wrong);
    }
});

test('ranges of days are the days of a week', () => {
    assert.deepEqual(policy.weekOf(staff).map((day) => day.length), [1, 1, 1, 1, 1, 0, 0]);
    assert.deepEqual(policy.weekOf({ weekly: { 'saturday-monday': ['08:00-09:00'] } }).map((day) => day.length), [1, 0, 0, 0, 0, 1, 1]);
    assert.deepEqual(policy.weekOf({}).flat(), []);
});

test('the days of a week are written as ranges, and read as they were', () => {
    for (const schedule of office.schedules) {
        const week = policy.weekOf(schedule);
        assert.deepEqual(policy.weekOf({ weekly: policy.weeklyOf(week) }), week);
        assert.deepEqual(policy.weeklyOf(week), schedule.weekly);
    }
    const uneven = [['01:00-02:00'], [], ['01:00-02:00'], ['01:00-02:00'], [], [], ['03:00-04:00']];
    assert.deepEqual(policy.weeklyOf(uneven), { monday: ['01:00-02:00'], 'wednesday-thursday': ['01:00-02:00'], sunday: ['03:00-04:00'] });
});

test('special days replace the hours of the week', () => {
    assert.deepEqual(policy.hoursOn(office, staff, '2026-12-25', 4), { periods: [], group: 'holidays' });
    assert.deepEqual(policy.hoursOn(office, staff, '2026-12-24', 3), { periods: ['07:00-12:00'], group: 'half-days' });
    assert.deepEqual(policy.hoursOn(office, staff, '2026-12-23', 2), { periods: ['07:00-19:00'], group: '' });
    assert.deepEqual(policy.hoursOn(office, nights, '2026-12-25', 4).group, '');
});

test('a door has the schedules of the profiles that name it, and levels', () => {
    const names = (door) => policy.schedulesAt(office, door).map(({ schedule, profiles }) => [schedule.token, ...profiles]);
    assert.deepEqual(names('front'), [['staff-hours', 'staff'], ['nights', 'night-guards'], ['visiting-hours', 'visitors']]);
    assert.deepEqual(names('back'), [['staff-hours', 'staff'], ['nights', 'night-guards']]);
    assert.deepEqual(names('other'), []);
    assert.deepEqual(policy.levelsAt(office, office.access_points[0]),
        { level: 'face', others: [{ level: 'card-and-pin', schedule: 'nights', state: 'active', two_people: false }] });
    assert.deepEqual(policy.levelsAt({}, { token: 'front' }), { level: 'face', others: [] });
});

test('hours and dates are read as people type them', () => {
    assert.deepEqual(policy.readPeriods(' 07:00-12:00,13:00-19:00 '), ['07:00-12:00', '13:00-19:00']);
    assert.deepEqual(policy.readPeriods(''), []);
    assert.throws(() => policy.readPeriods('7-12'), { message: 'period-wrong' });
    assert.throws(() => policy.readPeriods('13:00-19:00 07:00-12:00'), { message: 'periods-overlap' });
    assert.throws(() => policy.readPeriods('07:00-12:00 11:00-13:00'), { message: 'periods-overlap' });
    const many = Array.from({ length: 9 }, (_, i) => `0${i}:00-0${i}:30`).join(' ');
    assert.throws(() => policy.readPeriods(many), { message: 'too-many-periods' });
    assert.deepEqual(policy.readDates('2027-01-01\n2026-12-25, 2026-12-25'), ['2026-12-25', '2027-01-01']);
    assert.throws(() => policy.readDates('2026-02-30'), { message: 'date-wrong' });
    assert.throws(() => policy.readDates('25.12.2026'), { message: 'date-wrong' });
    const days = Array.from({ length: 65 }, (_, i) => new Date(Date.UTC(2026, 0, 1 + i)).toISOString().slice(0, 10)).join(' ');
    assert.throws(() => policy.readDates(days), { message: 'too-many-dates' });
});

test('a change leaves everything else as it is', () => {
    const before = JSON.stringify(office);
    const week = policy.weekOf(visiting).with(5, ['10:00-12:00']);
    const changed = policy.withHours(office, 'visiting-hours', week);
    assert.deepEqual(changed.schedules[1].weekly.saturday, ['10:00-12:00']);
    assert.deepEqual(changed.schedules[1].special_days, visiting.special_days);
    const dates = policy.withDates(changed, 'half-days', ['2027-12-24']);
    assert.deepEqual(dates.special_day_groups[1], { token: 'half-days', days: ['2027-12-24'] });
    assert.equal(JSON.stringify(office), before);
    assert.deepEqual({ ...dates, schedules: office.schedules, special_day_groups: office.special_day_groups }, office);
});

test('the week of a day begins on Monday', () => {
    assert.deepEqual(policy.datesOfWeek(new Date(2026, 10, 29)).at(0), '2026-11-23');
    assert.deepEqual(policy.datesOfWeek(new Date(2026, 10, 23)).at(0), '2026-11-23');
    assert.deepEqual(policy.datesOfWeek(new Date(2027, 0, 1)), ['2026-12-28', '2026-12-29', '2026-12-30', '2026-12-31', '2027-01-01', '2027-01-02', '2027-01-03']);
});

test('the text of a document is short, and the same document', () => {
    const text = policy.textOf(office);
    assert.deepEqual(JSON.parse(text), office);
    assert.ok(text.includes('"monday-thursday": ["09:00-12:00", "13:00-17:00"]'), text);
    assert.ok(text.split('\n').length < JSON.stringify(office, null, 2).split('\n').length - 30);
    const strange = { areas: [{ token: '[ "a",  "b" ]' }], list: ['a,  ', '["x"]', '\\', '",  "', '[', ']'], empty: [], mixed: [1, 'a'] };
    assert.deepEqual(JSON.parse(policy.textOf(strange)), strange);
    assert.deepEqual(JSON.parse(policy.textOf(policy.example('Europe/Berlin'))), policy.example('Europe/Berlin'));
});
