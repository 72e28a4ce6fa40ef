function NAME_test()
    % Poses of TITLE, compared with the joints that opm VERSION found.

    % The mode, the status, the pose, the joints and the imaginary joints; none where the pose is out of reach.
    golden = { ...
        ROWS
    };
    is_angle = [ANGLES];
    g = NAME.default();
    sizes = [g.joint.size];
    worst = 0;
    for i = 1:size(golden, 1)
        [status, joints] = NAME.inverse(g, golden{i, 3}, golden{i, 1});
        if status ~= golden{i, 2}
            error('pose %d: status %d, expected %d', i, status, golden{i, 2});
        end
        if status == 0
            off = abs(joints - golden{i, 4});
            % Full revolutions are no difference where half a revolution from home decides.
            round_trip = is_angle & off > pi;
            off(round_trip) = abs(off(round_trip) - 2 * pi);
            off = max(off ./ sizes);
            if ~(off <= 1e-10)
                error('pose %d: joints off by %g', i, off);
            end
            worst = max(worst, off);
        end
    end
    fprintf('NAME: %d poses, joints within %g\n', size(golden, 1), worst);
end
