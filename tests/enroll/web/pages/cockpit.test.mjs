/* The API inside Cockpit, with a scripted bus: it has the functions of the API by HTTP, and an
 * enrolment always gives the camera back. */

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from './sources.mjs';

const { makeCockpitApi } = await load('transport/cockpit.js');
const { http } = await load('transport/http.js');

/* A bus that answers by a table; an answer that is an Error is thrown. */
function script(answers) {
    const calls = [];
    const listeners = new Set();
    const cockpit = {
        calls,
        opened: [],
        emit: (name, ...args) => [...listeners].forEach((listener) => listener('/org/isotherm/Door0', 'org.isotherm.Door', name, args)),
        variant: (t, v) => ({ t, v }),
        user: async () => ({ name: 'Ada Lovelace' }),
        spawn: (words) => (words[0] === 'printenv' ? Promise.reject(new Error('exit code 1')) : cockpit.program(words)),
        dbus: (name, options) => ({
            addEventListener(event, listener) {
                cockpit.close = () => listener({}, { problem: 'not-found' });
                cockpit.opened.push(options);
            },
            close: () => cockpit.close(),
            async call(path, iface, method, args) {
                calls.push([method, ...args]);
                const answer = answers[method] ?? [];
                if (answer instanceof Error) {
                    throw answer;
                }
                return answer;
            },
            subscribe(match, listener) {
                listeners.add(listener);
                return { remove: () => listeners.delete(listener) };
            },
        }),
    };
    return cockpit;
}

const refusal = (name) => Object.assign(new Error('refused'), { name });
const denied = refusal('org.freedesktop.DBus.Error.AccessDenied');
const settle = () => new Promise((resolve) => { setImmediate(resolve); });

test('it has the functions of the API by HTTP, except those of accounts and updates', () => {
    const api = makeCockpitApi(script({}));
    const own = ['login', 'logout', 'changePassword', 'setup', 'accounts', 'addAccount', 'changeAccount', 'removeAccount',
        'update', 'bringUpdate', 'restart'];
    const missing = Object.keys(http).filter((name) => !(name in api) && !own.includes(name));
    assert.deepEqual(missing, []);
    assert.deepEqual(Object.keys(api.can).sort(), Object.keys(http.can).sort());
});

test('the bus decides the role', async () => {
    const role = async (answers) => (await makeCockpitApi(script(answers)).session()).role;
    assert.equal(await role({}), 'administrator');
    assert.equal(await role({ GetAddress: denied }), 'enroller');
    assert.equal(await role({ GetAddress: denied, ListPeople: denied }), 'observer');
    await assert.rejects(role({ GetStatus: denied }), { code: 'no-group' });
});

test('a page has its own connection, and opens another one when Cockpit has closed it', async () => {
    const bus = script({});
    const api = makeCockpitApi(bus);
    await api.status();
    await api.status();
    assert.deepEqual(bus.opened, [{ bus: 'none', address: 'unix:path=/run/dbus/system_bus_socket', superuser: 'try' }]);
    bus.close();
    await api.status();
    assert.equal(bus.opened.length, 2);
});

test('a channel that Cockpit closes because nobody owns the name means that the daemon is gone', async () => {
    const closed = Object.assign(new Error('not-found'), { name: null, problem: 'not-found' });
    assert.equal((await makeCockpitApi(script({ GetStatus: closed })).status()).daemon, false);
});

test('the findings of isotherm doctor come also if its exit code is not 0, in the words of the API', async () => {
    const bus = script({});
    /* As Cockpit does, and unlike other promises: the rejection has two values. */
    bus.program = () => ({ then: (done, failed) => failed(new Error('exit code 4'), '{"healthy":false,"checks":[{"subject":"door","state":"fault"}]}') });
    assert.deepEqual(await makeCockpitApi(bus).health(), { healthy: false, checks: [{ subject: 'door', state: 'bad' }] });
});

test('the settings of the daemon have the members of the API', async () => {
    const bus = script({ GetSettings: [[['door', 'backend', 'null', 'gpio', 'null gpio', 'what moves the door', false, 'null']]] });
    assert.deepEqual(await makeCockpitApi(bus).settings(),
        [{ section: 'door', key: 'backend', value: 'null', default: 'gpio', range: 'null gpio', help: 'what moves the door', changeable: false, configured: 'null' }]);
});

test('a setting is changed on the bus, and a bad value has a code of its own', async () => {
    const bus = script({});
    const api = makeCockpitApi(bus);
    await api.setSetting('decision', 'level', 'strict');
    await api.resetSetting('door', 'unlock_ms');
    assert.deepEqual(bus.calls.slice(-2), [['SetSetting', 'decision', 'level', 'strict'], ['ResetSetting', 'door', 'unlock_ms']]);
    const refused = makeCockpitApi(script({ SetSetting: refusal('org.isotherm.Error.InvalidArgument') }));
    await assert.rejects(refused.setSetting('decision', 'level', 'lax'), { code: 'invalid-setting' });
    const denied = makeCockpitApi(script({ SetSetting: refusal('org.freedesktop.DBus.Error.AccessDenied') }));
    await assert.rejects(denied.setSetting('decision', 'level', 'strict'), { code: 'not-allowed' });
});

test('a daemon that is gone is a state, not a fault', async () => {
    const gone = makeCockpitApi(script({ GetStatus: refusal('org.freedesktop.DBus.Error.ServiceUnknown') }));
    assert.deepEqual((({ daemon, status }) => ({ daemon, status }))(await gone.status()), { daemon: false, status: {} });
});

test('people and changes get to the bus with their types', async () => {
    const bus = script({ ListPeople: [[['Ada', 11, 22, 33, 4]]] });
    const api = makeCockpitApi(bus);
    assert.deepEqual((await api.people()).people[0],
        { name: 'Ada', enrolled_s: 11, valid_from_s: 22, valid_until_s: 33, templates: 4, last_seen_s: null });
    await api.changePerson('Ada', { name: 'Bea', valid_from_s: 0, valid_until_s: 5, expired: true });
    assert.deepEqual(bus.calls.slice(-2), [['RenamePerson', 'Ada', 'Bea'], ['SetValidity', 'Bea',
        { 'valid-from': { t: 'x', v: 0 }, 'valid-until': { t: 'x', v: 5 }, expired: { t: 'b', v: true } }]]);
});

test('the log is read backwards in pieces', async () => {
    const bus = script({ GetStatus: [{ 'log-sequence': { t: 't', v: 250 } }], ReadLog: [['{"sequence":150}', '{"sequence":200}']] });
    const { last, records } = await makeCockpitApi(bus).log({ before: 200, max: 50 });
    assert.deepEqual(bus.calls.at(-1), ['ReadLog', 150, 50]);
    assert.deepEqual([last, records], [250, [{ sequence: 150 }]]);
});

async function begun(answers = {}) {
    const bus = script(answers);
    const api = makeCockpitApi(bus);
    await api.session();
    const begin = api.beginEnrolment({ person: 'Bea', consent: true, poses: true });
    return { bus, api, begin };
}

test('an enrolment goes from the consent to its result', async () => {
    const { bus, api, begin } = await begun();
    const ends = bus.calls;
    await begin;
    assert.deepEqual(ends.slice(-3).map(([method]) => method), ['RecordAct', 'Claim', 'EnrollStart']);
    assert.deepEqual(ends.find(([method]) => method === 'RecordAct'), ['RecordAct', 'ada-lovelace', 'consent', 'Bea']);
    bus.emit('EnrollStep', 'frontal', 'begun', 1, 5, 0);
    bus.emit('EnrollStatus', 'enroll-retry-too-far', false, 0, 6, 0, '');
    assert.equal((await api.enrolment()).hint, 'too-far');
    bus.emit('EnrollStatus', 'enroll-stage-passed', false, 1, 6, 0.75, '');
    bus.emit('EnrollStep', 'frontal', 'passed', 1, 5, 0);
    const now = await api.enrolment();
    assert.deepEqual([now.hint, now.stage, now.stages, now.captures, now.steps],
        ['', 1, 6, [0.75], [{ pose: 'frontal', state: 'passed', turn_deg: 0 }]]);
    bus.emit('EnrollStatus', 'enroll-duplicate', true, 2, 6, 0, 'Cleo');
    await settle();
    const end = await api.enrolment();
    assert.deepEqual([end.state, end.result, end.known_as], ['ended', 'duplicate', 'Cleo']);
    assert.deepEqual(ends.slice(-2).map(([method]) => method), ['EnrollStop', 'Release']);
    api.abandon();
    assert.equal(ends.filter(([method]) => method === 'Release').length, 1);
});

test('without the right to name an account, the daemon is asked to record the consent', async () => {
    const { bus, begin } = await begun({ GetAddress: denied });
    await begin;
    assert.equal(bus.calls.some(([method]) => method === 'RecordAct'), false);
    assert.deepEqual(bus.calls.at(-1)[2].consent, { t: 'b', v: true });
});

test('the camera is given back when the enrolment cannot begin, is stopped, or the page goes away', async () => {
    const released = (bus) => bus.calls.filter(([method]) => method === 'Release').length;
    const full = await begun({ EnrollStart: refusal('org.isotherm.Error.GalleryFull') });
    await assert.rejects(full.begin, { code: 'gallery-full' });
    assert.deepEqual([released(full.bus), (await full.api.enrolment()).state], [1, 'none']);
    const stopped = await begun();
    await stopped.begin;
    await stopped.api.endEnrolment();
    assert.deepEqual([released(stopped.bus), (await stopped.api.enrolment()).result], [1, 'stopped']);
    await assert.rejects(stopped.api.endEnrolment(), { code: 'no-enrolment' });
    const left = await begun();
    await left.begin;
    left.api.abandon();
    assert.equal(released(left.bus), 1);
});

test('signals become events', async () => {
    const bus = script({ GetStatus: [{ lockdown: { t: 'b', v: true } }] });
    const seen = [];
    const stream = makeCockpitApi(bus).events((name, value) => seen.push([name, value]), () => {});
    await settle();
    bus.emit('Visit', 'deny', '', 1.5, 7, 3, 1200, 'unknown', '', '');
    bus.emit('Hint', 'too-far');
    stream.close();
    bus.emit('Hint', 'moving');
    assert.deepEqual(seen.map(([name]) => name), ['status', 'visit', 'hint']);
    assert.equal(seen[0][1].status.lockdown, true);
    assert.deepEqual([seen[1][1].verdict, seen[1][1].reason, seen[1][1].frames], ['deny', 'unknown', 3]);
});

test('nobody is enrolled without consent, or without its record', async () => {
    const bus = script({ RecordAct: refusal('org.isotherm.Error.Storage') });
    const api = makeCockpitApi(bus);
    await api.session();
    await assert.rejects(api.beginEnrolment({ person: 'Bea', consent: false }), { code: 'consent-required' });
    await assert.rejects(api.beginEnrolment({ person: 'Bea', consent: true }), { code: 'storage' });
    assert.equal(bus.calls.some(([method]) => method === 'Claim'), false);
});

test('administrators see cards, others do not ask for them', async () => {
    const people = [[['Ada', 11, 22, 33, 4], ['Bo', 12, 0, 0, 5]]];
    const bus = script({ ListPeople: people, ListCredentials: [[['Bo', '{"cards":["17/4711"],"enabled":false}']]] });
    const api = makeCockpitApi(bus);
    await api.session();
    const found = (await api.people()).people.map(({ cards, enabled }) => [cards, enabled]);
    assert.deepEqual(found, [[[], true], [['17/4711'], false]]);
    const other = script({ GetAddress: denied, ListPeople: people });
    const less = makeCockpitApi(other);
    await less.session();
    assert.equal((await less.people()).people[1].cards, undefined);
    assert.ok(!other.calls.some(([method]) => method === 'ListCredentials'));
});

test('cards and the policy get to the bus, and their errors have the codes of the web server', async () => {
    const answers = {
        GetPolicy: ['', 0], SetPolicy: [4, ['a finding']], CheckPolicy: [['a finding']],
        SetCredential: ['{"cards":[]}'], GetCredential: ['{"pin":true}'],
        TestAccess: [{ outcome: { t: 's', v: 'deny' }, wanted: { t: 'as', v: [] }, 'access-point': { t: 's', v: 'front' } }]
    };
    const bus = script(answers);
    const api = makeCockpitApi(bus);
    assert.deepEqual(await api.policy(), { revision: 0, document: null });
    assert.deepEqual(await api.storePolicy(3, { areas: [] }), { revision: 4, remarks: ['a finding'] });
    await api.storePolicy(4, null);
    assert.deepEqual(await api.findings(), ['a finding']);
    assert.deepEqual(await api.credential('Bo'), { pin: true });
    assert.deepEqual(await api.changeCredential('Bo', { pin: null }), { cards: [] });
    assert.deepEqual(await api.testAccess({ person: 'Bo', time: 5, shown: ['face'] }),
        { outcome: 'deny', wanted: [], access_point: 'front' });
    assert.deepEqual(bus.calls, [['GetPolicy'], ['SetPolicy', '{"areas":[]}', 3], ['SetPolicy', '', 4], ['CheckPolicy'],
        ['GetCredential', 'Bo'], ['SetCredential', 'Bo', '{"pin":null}'], ['TestAccess', 'Bo', '', 5, ['face']]]);
    answers.GetPolicy = ['{"areas":[]}', 7];
    assert.deepEqual(await api.policy(), { revision: 7, document: { areas: [] } });
    answers.SetPolicy = refusal('org.isotherm.Error.InvalidArgument');
    answers.SetCredential = refusal('org.isotherm.Error.NameInUse');
    answers.TestAccess = refusal('org.isotherm.Error.InvalidArgument');
    await assert.rejects(api.storePolicy(3, {}), { code: 'invalid-policy', detail: 'refused' });
    await assert.rejects(api.changeCredential('Bo', {}), { code: 'card-in-use' });
    await assert.rejects(api.testAccess({ person: 'Bo' }), { code: 'invalid-parameter' });
    answers.SetPolicy = refusal('org.isotherm.Error.Conflict');
    await assert.rejects(api.storePolicy(3, {}), { code: 'policy-changed' });
});

test('what the policy wants is shown until the visit ends', () => {
    const bus = script({});
    const seen = [];
    const api = makeCockpitApi(bus);
    const stream = api.outline((record) => seen.push([record.verdict, record.reason]), () => {});
    return settle().then(() => {
        const view = { capture: { t: 's', v: 'ok' } };
        bus.emit('View', view);
        bus.emit('Wanted', 'card');
        bus.emit('View', view);
        bus.emit('Visit', 'deny', 'Ada', 0, 0, 1, 1, 'not-enough', '', '');
        bus.emit('View', view);
        assert.deepEqual(seen, [['', ''], ['wait', 'card'], ['', '']]);
        stream.close();
    });
});
