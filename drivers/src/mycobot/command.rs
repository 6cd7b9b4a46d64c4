//! The commands, as data: byte, name, and the sizes of what is sent and what comes back.

use std::fmt;

/// Declares the commands once: variant, byte, the maker's name, payload sizes of the request and of the reply.
macro_rules! commands {
    ($($(#[doc = $doc:literal])* $variant:ident = $byte:literal, $name:literal, $request:expr, $reply:expr;)*) => {
        /// A command of the arm.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[repr(u8)]
        pub enum Command {
            $($(#[doc = $doc])* $variant = $byte,)*
        }

        impl Command {
            /// All of them, by their bytes.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];

            /// What the maker calls it.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// The sizes that a request's payload may have, in bytes.
            pub const fn request_sizes(self) -> &'static [usize] {
                match self { $(Self::$variant => &$request,)* }
            }

            /// The sizes that a reply's payload may have, in bytes.
            pub const fn reply_sizes(self) -> &'static [usize] {
                match self { $(Self::$variant => &$reply,)* }
            }
        }
    };
}

commands! {
    /// Version of the firmware's modification.
    GetModifyVersion = 0x01, "get_modify_version", [0], [1];
    /// Version of the firmware, in tenths.
    GetSystemVersion = 0x02, "get_system_version", [0], [1];
    /// What the arm has latched.
    GetErrorInformation = 0x07, "get_error_information", [0], [1, 2];
    /// Forgets that.
    ClearErrorInformation = 0x08, "clear_error_information", [0], [1];
    /// Power of the servos.
    PowerOn = 0x10, "power_on", [0], [1];
    /// Cuts the power of the servos: the arm falls.
    PowerOff = 0x11, "power_off", [0], [1];
    /// Whether the servos have power.
    IsPowerOn = 0x12, "is_power_on", [0], [1];
    /// Cuts the torque of all servos; damped unless the payload is 1.
    ReleaseAllServos = 0x13, "release_all_servos", [0, 1], [1];
    /// Whether the servos' controller answers.
    IsControllerConnected = 0x14, "is_controller_connected", [0], [1];
    /// The next error of the servos.
    ReadNextError = 0x15, "read_next_error", [0], [7];
    /// Whether a new goal replaces the one before.
    SetFreshMode = 0x16, "set_fresh_mode", [1], [1];
    /// The same, read.
    GetFreshMode = 0x17, "get_fresh_mode", [0], [1];
    /// Whether the arm may be moved by hand.
    SetFreeMode = 0x1A, "set_free_mode", [1], [1];
    /// The same, read.
    IsFreeMode = 0x1B, "is_free_mode", [0], [1];
    /// Joint angles, 0.01 deg.
    GetAngles = 0x20, "get_angles", [0], [12];
    /// Goal of one joint.
    SendAngle = 0x21, "send_angle", [4], [1];
    /// Goals of all joints.
    SendAngles = 0x22, "send_angles", [13], [1];
    /// Position (0.1 mm) and orientation (0.01 deg) of the flange.
    GetCoords = 0x23, "get_coords", [0], [12];
    /// Goal of one coordinate.
    SendCoord = 0x24, "send_coord", [4], [1];
    /// Goals of all coordinates.
    SendCoords = 0x25, "send_coords", [13, 14], [1];
    /// Halts; the goal is kept.
    Pause = 0x26, "pause", [0], [1];
    /// Whether it is halted.
    IsPaused = 0x27, "is_paused", [0], [1];
    /// Goes on.
    Resume = 0x28, "resume", [0], [1];
    /// Halts and forgets the goals.
    Stop = 0x29, "stop", [0], [1];
    /// Whether the arm is at angles or coordinates.
    IsInPosition = 0x2A, "is_in_position", [13], [1];
    /// Whether it moves.
    IsMoving = 0x2B, "is_moving", [0], [1];
    /// Moves a joint until it is stopped.
    JogAngle = 0x30, "jog_angle", [3], [1];
    /// Moves a joint by an angle.
    JogIncrementAngle = 0x33, "jog_increment_angle", [4], [1];
    /// Prepares the gripper.
    InitGripper = 0x38, "init_gripper", [0], [1];
    /// Goal of one servo, in ticks.
    SetEncoder = 0x3A, "set_encoder", [4], [1];
    /// Position of one servo, in ticks.
    GetEncoder = 0x3B, "get_encoder", [1], [2];
    /// Goals of all servos, in ticks.
    SetEncoders = 0x3C, "set_encoders", [13], [1];
    /// Positions of all servos, in ticks.
    GetEncoders = 0x3D, "get_encoders", [0], [12];
    /// Lower limit of a joint, 0.1 deg.
    GetJointMin = 0x4A, "get_joint_min_angle", [1], [2, 3];
    /// Upper limit of a joint, 0.1 deg.
    GetJointMax = 0x4B, "get_joint_max_angle", [1], [2, 3];
    /// Sets the lower limit of a joint.
    SetJointMin = 0x4C, "set_joint_min", [3], [1];
    /// Sets the upper limit of a joint.
    SetJointMax = 0x4D, "set_joint_max", [3], [1];
    /// Whether a servo holds its joint.
    IsServoEnable = 0x50, "is_servo_enable", [1], [1, 2];
    /// Whether all servos do.
    IsAllServoEnable = 0x51, "is_all_servo_enable", [0], [1, 6];
    /// Cuts the torque of one servo; damped unless a second byte is 1.
    ReleaseServo = 0x56, "release_servo", [1, 2], [1];
    /// Torque of one servo, or of all with id 0.
    FocusServo = 0x57, "focus_servo", [1], [1];
    /// Opening of the gripper, in percent.
    GetGripperValue = 0x65, "get_gripper_value", [0, 1], [1];
    /// Opens, closes or releases the gripper.
    SetGripperState = 0x66, "set_gripper_state", [2, 3, 4], [1];
    /// Goal of the gripper, in percent.
    SetGripperValue = 0x67, "set_gripper_value", [2, 3, 4], [1];
    /// Makes the gripper's position its zero.
    SetGripperCalibration = 0x68, "set_gripper_calibration", [0], [1];
    /// Whether the gripper moves.
    IsGripperMoving = 0x69, "is_gripper_moving", [0], [1];
    /// Colour of the LED.
    SetColor = 0x6A, "set_color", [3], [1];
    /// Output pin of an M5's base.
    SetBasicOutput = 0xA0, "set_basic_output", [2], [1];
    /// Version of an M5's base, in tenths.
    GetBasicVersion = 0xC1, "get_basic_version", [0], [1];
    /// Angles and coordinates at once.
    GetAnglesCoords = 0xD5, "get_angles_coords", [0], [24];
    /// How often the arm was started.
    GetRebootCount = 0xD8, "get_reboot_count", [0], [2];
    /// Speeds of the servos.
    GetServoSpeeds = 0xE1, "get_servo_speeds", [0], [12];
    /// Voltages of the servos, 0.1 V.
    GetServoVoltages = 0xE3, "get_servo_voltages", [0], [6];
    /// Temperatures of the servos, deg C.
    GetServoTemps = 0xE5, "get_servo_temps", [0], [6];
    /// The joint angles that the arm is making for.
    GetAnglesPlan = 0xF6, "get_angles_plan", [0], [12];
    /// The coordinates that it is making for.
    GetCoordsPlan = 0xF7, "get_coords_plan", [0], [12];
}

impl Command {
    /// The command of a byte.
    pub fn of_byte(byte: u8) -> Option<Self> {
        Self::ALL.iter().copied().find(|command| *command as u8 == byte)
    }

    /// Whether carrying it out twice does what carrying it out once does, so that it may be sent again when no reply
    /// came. A move by an angle is not of that kind: its first sending may have been carried out.
    pub const fn is_repeatable(self) -> bool {
        !matches!(self, Self::JogIncrementAngle)
    }

    /// Whether a reply of another value than 1 means that the arm refused.
    pub const fn is_acknowledged(self) -> bool {
        matches!(
            self,
            Self::ClearErrorInformation
                | Self::PowerOn
                | Self::PowerOff
                | Self::ReleaseAllServos
                | Self::SetFreshMode
                | Self::SetFreeMode
                | Self::SendAngle
                | Self::SendAngles
                | Self::SendCoord
                | Self::SendCoords
                | Self::Pause
                | Self::Resume
                | Self::Stop
                | Self::JogAngle
                | Self::JogIncrementAngle
                | Self::InitGripper
                | Self::SetEncoder
                | Self::SetEncoders
                | Self::SetJointMin
                | Self::SetJointMax
                | Self::ReleaseServo
                | Self::FocusServo
                | Self::SetGripperState
                | Self::SetGripperValue
                | Self::SetGripperCalibration
                | Self::SetColor
                | Self::SetBasicOutput
        )
    }
}

impl fmt::Display for Command {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (0x{:02X})", self.name(), *self as u8)
    }
}
