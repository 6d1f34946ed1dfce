"""Headers as instruments and programs write them: each file opens, or is told what to do."""

import datetime

import numpy as np
import pytest

from stickslip import ScenarioError, models

K = np.arange(12)
T, Y, U = 0.02 * K, np.cos(K), np.where(K < 6, 1.0, -0.5)
RPM, DEG = 30.0 / np.pi, 180.0 / np.pi
MODELS = {
    "joint": models.joint(inertia=0.1),
    "angle": models.joint(inertia=0.1, reads="angle"),
    "heater": models.thermal(capacity=400.0, loss=1.5, ambient=20.0),
    "servo": models.servo(inertia=0.02, torque_constant=1.0, resistance=3.0, supply=12.0, gain=3.0),
    "spring": models.oscillator(mass=1.0, stiffness=40.0),
}


def clock(form, step=10.0):
    begin = datetime.datetime(2026, 5, 1, 12)
    return [(begin + datetime.timedelta(seconds=step * int(k))).strftime(form) for k in K]


SPEED = 'column "speed" is missing; there are '
TIME = 'column "t" is missing; there are '
# Instrument: the lines above the rows, the columns of the rows, the model, what the refusal says.
HEADERS = {
    "Tektronix": ("Model,MSO46\nHorizontal Units,s,s\nSample Interval,2e-2,2e-2\n"
                  "Vertical Units,V,V\nLabel,,\n\nTIME,CH1,CH2", (T, Y, U), "joint",
                  f'line 7: {SPEED}"TIME", "CH1"'),
    "Yokogawa": ('"Model","DLM3054"\n"Date","2026/11/28"\n\nTIME,torque,speed\ns,Nm,rpm',
                 (T, U, RPM * Y), "joint", ""),
    "Rigol": ("X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,0,2e-2", (K, Y, U, [""] * 12),
              "joint", f'{TIME}"X", "CH1"'),
    "PicoScope": ("Time,speed,torque\n(ms),(rpm),(mNm)\n", (1e3 * T, RPM * Y, 1e3 * U), "joint",
                  ""),
    "Keysight": ("x-axis,1,2\nsecond,Volt,Volt", (T, Y, U), "joint",
                 f'{SPEED}"x-axis (second)", "1 (Volt)"'),
    "LeCroy": ("LECROYWR64Xi,12345,Waveform\nSegments,1,SegmentSize,12\n"
               "#1,28-Mar-2026 17:22:52,0\nTime,Ampl", (T, Y), "joint",
                  f'line 4: {SPEED}"Time", "Ampl"'),
    "Siglent": ("Record Length,Analog:7000\nSample Interval,Analog:0.02\nVertical Units,V,V\n"
                "Vertical Scale,1.00E+00,1.00E+00\nModel Number,SDS1104X-E\nSecond,Value,Value",
                (T, Y, U), "joint", 'line 6: column "Value" is there twice'),
    "Rohde & Schwarz named": ("Time in s,Speed in rpm,Torque in Nm", (T, RPM * Y, U), "joint", ""),
    "Digilent": ("#Digilent WaveForms Oscilloscope Acquisition\n#Sample rate: 50Hz\n\n"
                 "Time (s),Speed (rpm),Torque (mNm)", (T, RPM * Y, 1e3 * U), "joint", ""),
    "Campbell": ('"TOA5","CR1000X","1234","Table1"\n"TIMESTAMP","RECORD","Temp_Avg","Power"\n'
                 '"TS","RN","Deg C","W"\n"","","Avg","Smp"',
                 (clock('"%Y-%m-%d %H:%M:%S"'), K, Y, U), "heater", ""),
    "HOBO": ('"Plot Title: heater"\n"#","Date Time, GMT+02:00","Temp, °C (LGR S/N: 1)","Power, W"',
             (K, clock("%m/%d/%y %I:%M:%S %p"), Y, U), "heater", f'line 2: {TIME}"#", "Date Time'),
    "LabVIEW": ("LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n"
                "X_Value\tSpeed\tTorque", (T, Y, U), "joint", "is a LabVIEW measurement file"),
    "BenchLink": ("Name:,heater\nScan,Time,101 (C),102 (W)",
                  (K, clock("%m/%d/%Y %H:%M:%S:000"), Y, U), "heater", "a date such as 2026-05-01"),
    "Graphtec": ("Vendor,GRAPHTEC Corporation\nData\nNumber,Date&Time,ms,CH1,CH2\n"
                 "NO.,Time,ms,degC,W", (K, clock("%Y/%m/%d %H:%M:%S"), 0 * K, Y, U), "heater",
                  'call one "power (W)"'),
    "catman": ("Zeit [s];Drehzahl [1/min];Drehmoment [Nm]", (T, RPM * Y, U), "joint", ""),
    "Testo": ("Datum;Zeit;Temperatur [°C];Leistung [W]",
              (clock("%d.%m.%Y"), clock("%H:%M:%S"), Y, U), "heater", f'{TIME}"Datum", "Zeit"'),
    "Arduino": ("t_ms,rpm,torque_mNm", (1e3 * T, RPM * Y, 1e3 * U), "joint", ""),
    "a logger that began anew": (
        "t_ms,rpm,torque_mNm\n0,0,1\n20,1,1\nt_ms,rpm,torque_mNm",
        (1e3 * T, RPM * Y, 1e3 * U), "joint", 'line 4, column t = "t_ms"'),
    "timetable of MATLAB": ("Time,speed,torque", ([f"{t:g} sec" for t in T], Y, U), "joint",
                            'column t = "0 sec": allowed is a finite number of s'),
    "pandas": (",t,speed,torque", (K, T, Y, U), "joint", ""),
    "Excel": ("sep=;\nt (s);speed (rpm);torque (N m);mode", (T, RPM * Y, U, ["load"] * 12),
              "joint", ""),
    "InfluxDB": ("#group,false,false,false,false,false\n#datatype,string,long,"
                 "dateTime:RFC3339,double,double\n#default,mean,,,,\n,result,table,_time,speed,torque",
                 ([""] * 12, [""] * 12, 0 * K, clock("%Y-%m-%dT%H:%M:%S.%fZ", 0.02), Y, U),
                 "joint", ""),
    "Grafana": ('"Time","speed","torque"', (clock('"%Y-%m-%d %H:%M:%S.%f"', 0.02), Y, U),
                "joint", ""),
    "PlotJuggler": ("__time,/motor/velocity,/motor/effort", (1777636800 + T, Y, U), "joint",
                    f'{SPEED}"__time", "/motor/velocity"'),
    "rostopic": ("%time,field.header.seq,speed,torque",
                 ([f"{1777636800000000000 + 20000000 * k}" for k in K], K, Y, U), "joint", ""),
    "TwinCAT": ("Name\tAxis1.ActVelo\tName\tAxis1.ActTorque\n"
                "SampleTime[ms]\t20\tSampleTime[ms]\t20\n", (1e3 * T, Y, 1e3 * T, U), "joint",
                  'column "Name" is there twice'),
    "Siemens": ('"Sample";"Time [ms]";"n_act [rpm]";"M_act [Nm]"', (K, 1e3 * T, RPM * Y, U),
                "joint", ""),
    "ODrive": ("time,vel_estimate,torque_setpoint", (T, Y, U), "joint", 'call one "speed (rad/s)"'),
    "EPOS": ("Time [ms];Velocity Actual Value [rpm];Torque Actual Value [mNm]",
             (1e3 * T, RPM * Y, 1e3 * U), "joint", ""),
    "Dynamixel": ("time(ms),Present Position(deg),Goal Position(deg)", (1e3 * T, DEG * Y, DEG * U),
                  "servo", ""),
    "an angle for a speed": ("t (s),torque (N m),angle (deg)", (T, U, DEG * Y), "joint",
                             'with reads="angle" (--set reads=angle) the model reads that'),
    "an encoder": ("time_us,angle_deg,torque_Nm", (1e6 * T, DEG * Y, U), "angle", ""),
    "Instron": ("Specimen label,1\n\nTime,Extension,Load\n(s),(mm),(kN)",
                (T, 1e3 * Y, 1e-3 * U), "spring", ""),
    "Zwick": ("Prüfzeit;Standardweg;Standardkraft\ns;mm;N", (T, 1e3 * Y, U), "spring", ""),
    "Keyence": ("Date,Time,Elapsed (ms),OUT1 (mm)",
                (clock("%Y/%m/%d", 0.02), clock("%H:%M:%S", 0.02), 1e3 * T, 1e3 * Y), "spring",
                "more digits"),
}  # fmt: skip

# Of programs whose headings state none.
UNITS = {"pandas": "si", "InfluxDB": "si", "Grafana": "si",
         "rostopic": {"%time": "ns", "speed": "rad/s", "torque": "N m"}}  # fmt: skip


@pytest.mark.parametrize("name", HEADERS)
def test_a_file_opens_or_its_refusal_says_what_to_do(name, tmp_path):
    head, columns, kind, said = HEADERS[name]
    last = head.strip().splitlines()[-1]
    between = next(sign for sign in "\t;," if sign in last)
    text = [[each if isinstance(each, str) else f"{each:.14g}" for each in row] for row in columns]
    rows = [between.join(row) for row in zip(*text, strict=True)]
    if name in ("catman", "Zwick"):
        rows = [row.replace(".", ",") for row in rows]
    (tmp_path / "a.csv").write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    if said:
        with pytest.raises(ScenarioError) as error:
            models.read_log(tmp_path / "a.csv", MODELS[kind], UNITS.get(name))
        assert said in str(error.value)
        return
    log = models.read_log(tmp_path / "a.csv", MODELS[kind], UNITS.get(name))
    assert log.t == pytest.approx((500.0 if kind == "heater" else 1.0) * T, abs=1e-6)
    assert log.y == pytest.approx(Y, abs=1e-9)
    assert next(iter(log.inputs.values())) == pytest.approx(U, abs=1e-9)
