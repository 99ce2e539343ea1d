/* The API inside Cockpit: D-Bus calls of the user who is logged in there. It has the functions of
 * transport/http.js. Cockpit's login and the groups of the bus decide who may do what, so there are
 * no accounts. Streams of descriptors do not get through Cockpit: instead of the outline there are
 * the words of the signal View. */

import {accessCalls} from './cockpit_access.js';
import {CockpitEnrolment} from './cockpit_enrolment.js';
import {DoorBus} from './door_bus.js';
import {Fault} from './fault.js';

const SILENT_MS = 5000;

/* The words of `isotherm doctor` as those of the API. */
const FOUND = {
    ok: 'good',
    warning: 'odd',
    denied: 'denied',
    fault: 'bad'
};

const seconds = (value) => Number(value) || 0;

function toPerson([name, enrolled, from, until, templates]) {
    return {
        name,
        enrolled_s: seconds(enrolled),
        valid_from_s: seconds(from),
        valid_until_s: seconds(until),
        templates,
        last_seen_s: null
    };
}

function toVisit([verdict, person, score, threshold, frames, latency_us, reason, door, door_fault]) {
    return {
        time: new Date().toISOString(),
        verdict,
        person,
        score,
        threshold,
        frames,
        latency_us,
        reason,
        door,
        door_fault
    };
}

/* The role that the bus gives this user: it refuses the calls of higher ones. */
async function findRole(bus) {
    if (await bus.allows('GetAddress', [])) {
        return 'administrator';
    }
    return await bus.allows('ListPeople', []) ? 'enroller' : 'observer';
}

export function makeCockpitApi(cockpit) {
    const bus = new DoorBus(cockpit);
    const enrolment = new CockpitEnrolment(bus);
    const access = accessCalls(bus);
    let role = 'observer';
    let account = '';
    let ask = () => {}; /* asks for the state at once, while a page listens */

    async function status() {
        try {
            return { time: new Date().toISOString(), daemon: true, status: await bus.values('GetStatus') };
        } catch (fault) {
            if (fault.code !== 'no-daemon') {
                throw fault;
            }
            return { time: new Date().toISOString(), daemon: false, status: {} };
        }
    }

    function events(on, onState) {
        ask = async () => {
            try {
                on('status', await status());
                onState(true);
            } catch (fault) {
                onState(false, fault);
            }
        };
        const signals = {
            Visit: (args) => on('visit', toVisit(args)),
            Hint: ([word]) => on('hint', { word }),
            DoorChanged: ([state, cause]) => {
                on('door', { state, cause });
                ask();
            },
        };
        const subscription = bus.subscribe((name, args) => signals[name]?.(args));
        enrolment.listen((state) => on('enrolment', state));
        const timer = setInterval(() => ask(), SILENT_MS);
        ask();
        return {
            close() {
                clearInterval(timer);
                ask = () => {};
                subscription.remove();
                enrolment.listen(() => {});
            },
        };
    }

    /* Words of what the camera sees, in the form of an outline without points. What the policy wants
     * besides is wanted until the visit has ended. */
    function outline(onRecord, onState) {
        let wanted = '';
        const subscription = bus.subscribe((name, [view] = []) => {
            if (name === 'Wanted' || name === 'Visit') {
                wanted = name === 'Wanted' ? view : '';
            }
            if (name === 'View') {
                const seen = bus.plain(view);
                onRecord({
                    hint: seen.capture ?? '',
                    distanceMm: seen['distance-mm'] ?? 0,
                    verdict: wanted ? 'wait' : '',
                    reason: wanted,
                    outline: [],
                    silhouette: new Uint8Array(600)
                });
            }
        });
        bus.call('AimStart', []).catch((fault) => onState(false, fault));
        return {
            close() {
                subscription.remove();
                bus.call('AimStop', []).catch(() => {});
            },
        };
    }

    /* Only administrators see cards. */
    async function people() {
        const cards = role === 'administrator' ? await access.cards() : null;
        const withCards = (person) => {
            const { cards: own = [], enabled = true } = cards.get(person.name) ?? {};
            return {...person, cards: own, enabled };
        };
        const list = (await bus.call('ListPeople', []))[0].map(toPerson);
        return { people: cards ? list.map(withCards) : list, log_read: true };
    }

    async function changePerson(name, change) {
        let present = name;
        let remark = '';
        if (change.name !== undefined && change.name !== name) {
            [remark] = await bus.call('RenamePerson', [name, change.name]);
            present = change.name;
        }
        if (change.valid_from_s !== undefined || change.valid_until_s !== undefined) {
            await bus.call('SetValidity', [present, bus.options(change)], 'sa{sv}');
        }
        return { remark };
    }

    /* ReadLog reads forwards from a number; the page asks for what is before one. */
    async function log({ before, from, max = 100 }) {
        const last = seconds((await bus.values('GetStatus'))['log-sequence']);
        const begin = from ?? Math.max(1, (before ?? last + 1) - max);
        const count = before === undefined ? max : Math.min(max, before - begin);
        const [lines] = count > 0 ? await bus.call('ReadLog', [begin, count], 'tu') : [[]];
        return {
            last,
            records: lines.map((line) => JSON.parse(line))
                         .filter((record) => before === undefined || record.sequence < before)
        };
    }

    async function verifyLog() {
        const [sound, first, last, head, flaw_at, flaw] = await bus.call('VerifyLog', [0, ''], 'ts', 600000);
        return { sound, first, last, head, flaw_at, flaw };
    }

    /* What the command line tool finds, which knows the remedies. */
    async function health() {
        /* If something is wrong, the exit code is not 0. Cockpit then rejects with two values: the
         * error, and what was printed. */
        const found = await bus.doctor(await new Promise((resolve) => {
            cockpit.spawn(['isotherm', 'doctor', '--json'], { superuser: 'try', err: 'ignore' })
                .then(resolve, (error, printed) => resolve(printed ?? ''));
        }));
        const checks = (found.checks ?? []).map((check) => ({...check, state: FOUND[check.state] ?? check.state }));
        return { healthy: found.healthy === true, checks };
    }

    /* No signal tells of these changes. */
    async function change(method, args, type) {
        await bus.call(method, args, type);
        await ask();
    }

    async function settings() {
        const [list] = await bus.call('GetSettings', []);
        return list.map(
            ([section, key, value, standard, range, help, changeable, configured]) =>
                ({ section, key, value, default: standard, range, help, changeable, configured }));
    }

    /* The daemon's word for a bad argument is that of limits everywhere else. */
    async function changeSetting(method, args, type) {
        try {
            await bus.call(method, args, type);
        } catch (fault) {
            throw fault.code === 'invalid-limits' ? new Fault('invalid-setting', { detail: fault.detail }) : fault;
        }
    }

    return {
        kind: 'cockpit',
        can: { accounts: false, outline: false, relief: false, settings: true, login: false, update: false },
        onLoginRequired() {},
        async session() {
            account = (await cockpit.user()).name;
            enrolment.account = account;
            await bus.values('GetStatus').catch((fault) => {
                if (fault.code === 'not-allowed') {
                    bus.close(); /* the next attempt may have other rights */
                    throw new Fault('no-group', { detail: fault.detail });
                }
            });
            role = await findRole(bus);
            return { account, role };
        },
        status,
        health,
        settings,
        setSetting: (section, key, value) => changeSetting('SetSetting', [section, key, value], 'sss'),
        resetSetting: (section, key) => changeSetting('ResetSetting', [section, key], 'ss'),
        setLockdown: (on) => change('SetLockdown', [on], 'b'),
        clearLockout: () => change('ClearLockout', []),
        people,
        ...access,
        changePerson,
        removePerson: (name) => bus.call('DeletePerson', [name], 's'),
        enrolment: async () => enrolment.state,
        beginEnrolment: (wish) => enrolment.begin(wish, role === 'administrator'),
        endEnrolment: () => enrolment.end(),
        abandon: () => enrolment.abandon(),
        log,
        verifyLog,
        events,
        outline,
        relief: () => ({ close() {} }),
    };
}
