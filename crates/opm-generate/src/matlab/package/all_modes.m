function [status, joints, imaginary] = all_modes(g, pose)
    % Every joint in all working modes: a row for each mode, from 0 on, and its status.

HEAD
    for mode = 0:(2^CHOICES - 1)
        [status(mode + 1, 1), joints(mode + 1, :), imaginary(mode + 1, :)] = NAME.inverse(g, pose, mode);
    end
end
